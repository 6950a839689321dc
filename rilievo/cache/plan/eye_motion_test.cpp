#include "rilievo/cache/plan/eye_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rilievo {
namespace {

TEST(EyeMotion, a_jump_is_told_from_a_motion_that_becomes_faster) {
  EyeMotion motion;
  const auto at = [](double x) {
    return look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}, 1.0, 640, 360, 0.1, 100);
  };
  for (int frame = 0; frame < 2; ++frame) {
    const FrameView view = follow(motion, at(0));
    EXPECT_FALSE(view.jumped || view.started);
    EXPECT_EQ(view.step, 0);
  }
  const FrameView first_step = follow(motion, at(0.1));
  EXPECT_FALSE(first_step.jumped);
  EXPECT_TRUE(first_step.started);
  EXPECT_DOUBLE_EQ(first_step.step, 0.1);
  EXPECT_FALSE(follow(motion, at(0.1)).started);
  EXPECT_FALSE(follow(motion, at(0.2)).jumped);
  EXPECT_FALSE(follow(motion, at(0.8)).jumped);  // a frame that took six times as long
  EXPECT_FALSE(follow(motion, at(0.9)).jumped);
  EXPECT_TRUE(follow(motion, at(6)).jumped);
  for (int frame = 0; frame < 3; ++frame) EXPECT_FALSE(follow(motion, at(6)).jumped);
  EXPECT_FALSE(follow(motion, at(6.1)).jumped);  // it walks again
  EXPECT_TRUE(follow(motion, at(0)).jumped);     // a jump is not what it may be compared with
  EXPECT_TRUE(follow(motion, at(5.1)).jumped);   // the way back is another one
  EXPECT_FALSE(follow(motion, at(5.2)).jumped);
  EXPECT_TRUE(follow(motion, at(0)).jumped);
  EXPECT_FALSE(follow(motion, at(-5.2)).jumped);  // or else a motion, if it goes on
  EXPECT_FALSE(follow(motion, at(-5.1)).jumped);
  const auto turned = [&](double x, double radians) {
    return look_at({x, 0, 0}, {x + std::sin(radians), 0, -std::cos(radians)}, {0, 1, 0}, 1.0, 640,
                   360, 0.1, 100);
  };
  EXPECT_FALSE(follow(motion, turned(5.3, 0.05)).jumped);
  EXPECT_FALSE(follow(motion, turned(5.4, 0.1)).jumped);
  EXPECT_TRUE(follow(motion, turned(5.5, 1.5)).jumped);
  // The first turn of an eye that stood.
  for (const double turn : {0.4, 0.6}) {
    EyeMotion standing;
    for (int frame = 0; frame < 2; ++frame) (void)follow(standing, turned(0, 0));
    const FrameView view = follow(standing, turned(0, turn));
    EXPECT_TRUE(view.started);
    EXPECT_EQ(view.jumped, turn > 0.5);
  }
  // A step that is long for a walk is no jump if it is short for the jump before it.
  EyeMotion walk;
  for (const double x : {0.0, 0.1, 0.2}) (void)follow(walk, at(x));
  EXPECT_TRUE(follow(walk, at(600)).jumped);
  EXPECT_FALSE(follow(walk, at(595)).jumped);
}

}  // namespace
}  // namespace rilievo

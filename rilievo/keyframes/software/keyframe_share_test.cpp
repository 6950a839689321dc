// How much of a frame's time do keyframes get?
#include <gtest/gtest.h>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/keyframes/software/keyframe_frames.h"

namespace rilievo {
namespace {

// An eye that moves along a wall: nothing is hidden, and next to no time goes into holes.
int completed_along_a_wall(double share, double pace_ms) {
  Scene scene;
  test_shapes::add(scene, test_shapes::box({40, 30, 0.1f}), {0.7f, 0.5f, 0.3f});
  KeyframeFramesOptions options;
  options.keyframes.keyframe_ms = 1e-6, options.keyframe_share = share;
  options.polygons_where_cheaper = false;
  auto frames = KeyframeFrames::create(scene, options);
  EXPECT_TRUE(frames.ok());
  (*frames)->set_pace(pace_ms);
  int completed = 0;
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 at(0.02 * i, 0, 8);
    const Camera camera = look_at(at, at - glm::dvec3(0, 0, 1), {0, 1, 0}, 0.9, 640, 360, 0.1, 100);
    EXPECT_TRUE((*frames)->draw(camera, 0));
    completed += (*frames)->shares().completed;
  }
  return completed;
}

// Each takes 32 frames, or 16 where frames may spend a thousand times their time on it, if the pace
// leaves any of that.
TEST(KeyframeFrames, AShareOfFramesMakesKeyframesSoonerIfThePaceAllowsIt) {
  const int soon = completed_along_a_wall(1000, 0);
  EXPECT_GE(soon, 5);
  EXPECT_LT(completed_along_a_wall(0, 0), soon);
  EXPECT_LT(completed_along_a_wall(1000, 1e-6), soon);
}

}  // namespace
}  // namespace rilievo

#include "apps/rilievo/frame_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

namespace rilievo::app {
namespace {

// Whatever the number of frames, no step between two keys is a cut.
TEST(FrameOptions, an_orbit_is_one_turn_in_its_frames) {
  Box box;
  box.add(glm::vec3(-2, 0, -1)), box.add(glm::vec3(4, 3, 1));
  const glm::dvec3 center(box.center());
  for (const int frames : {1, 2, 4, 7, 60, 500}) {
    FrameOptions options;
    options.orbit = frames;
    const Result<FramePlan> plan = plan_frames(options, box, glm::dvec3(0));
    ASSERT_TRUE(plan.ok());
    EXPECT_EQ(plan->frames, frames);
    const auto at = [&](int frame) {
      return camera_at(plan->path, frame_time(plan->path, frame), 8, 8).position() - center;
    };
    const glm::dvec3 first = at(0);
    for (int frame = 0; frame <= frames; ++frame) {
      const double turned = 2 * glm::pi<double>() * frame / frames, c = std::cos(turned),
                   s = std::sin(turned);
      const glm::dvec3 expected(c * first.x + s * first.z, first.y, c * first.z - s * first.x);
      // The curve through a key a degree leaves the circle by less than 1e-6 of its radius.
      EXPECT_LT(glm::distance(at(frame), expected), 1e-5 * glm::length(first)) << frame;
    }
    for (std::size_t k = 0; k + 1 < plan->path.keys.size(); ++k)
      EXPECT_FALSE(is_cut(plan->path.keys[k], plan->path.keys[k + 1]));
  }
  // Of which fewer frames may be drawn.
  FrameOptions options;
  options.orbit = 30, options.frames = 3;
  EXPECT_EQ(plan_frames(options, box, glm::dvec3(0))->frames, 3);
}

}  // namespace
}  // namespace rilievo::app

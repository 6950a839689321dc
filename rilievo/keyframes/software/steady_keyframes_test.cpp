// Does a steady frame of keyframes allocate memory?
#include <gtest/gtest.h>

#include "rilievo/core/count_allocations_test_helpers.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/scene/builtin/builtin.h"

#ifndef RILIEVO_OPERATORS_ARE_TAKEN

namespace rilievo {
namespace {

// The eye stands: keyframes are complete, and frames are warped, filled and drawn. Captures of
// keyframes make pictures, and are not meant.
TEST(KeyframeFrames, frames_of_an_eye_that_stands_allocate_nothing) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 4;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames.ok());
  const Camera camera = camera_at(made.path, 0, 160, 100);
  const void* volatile probe = new int;
  EXPECT_GT(allocations_here, 0u);  // they are counted
  delete static_cast<const int*>(probe);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE((*frames)->draw(camera, 0).ok());
  const std::size_t before = allocations_here;
  for (int i = 0; i < 20; ++i) {
    const bool drawn = (*frames)->draw(camera, 0).ok();
    if (!drawn) FAIL();
  }
  EXPECT_EQ(allocations_here - before, 0u);
}

}  // namespace
}  // namespace rilievo

#endif

// Does a steady frame of keyframes allocate memory?
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/count_allocations_test_helpers.h"
#include "rilievo/keyframes/software/hole_points.h"
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

TEST(HolePoints, SteadyFramesAllocateNothing) {
  const bool included[] = {true};
  const Camera camera = look_at({0, 0, 0}, {0, 0, -10}, {0, 1, 0}, 0.9, 60, 40, 0.1, 500);
  std::vector<FramePixel> holes;
  for (int i = 0; i < 60 * 40; i += 2)
    holes.push_back({std::uint16_t(i % 60), std::uint16_t(i / 60)});
  std::vector<FoundInHole> found;
  for (const FramePixel pixel : holes) found.push_back({pixel, 0.1f, 0xff0000ffu, 0});
  HolePoints points;
  points.keep(camera, found);
  std::size_t before = 0;
  for (int i = 0; i < 20; ++i) {
    if (i == 10) before = allocations_here;
    points.show(camera, holes, included);
    // A quarter is found anew, the others stay.
    points.keep(camera, std::span(found).first(i % 2 == 0 ? found.size() / 4 : 0));
  }
  EXPECT_EQ(allocations_here - before, 0u);
}

TEST(HolePoints, FirstFramesAllocateNothingWhereMemoryWasTaken) {
  const bool included[] = {true};
  const Camera camera = look_at({0, 0, 0}, {0, 0, -10}, {0, 1, 0}, 0.9, 60, 40, 0.1, 500);
  // Half of the holes are seen by points, which stay, and half by rays: as much as memory is for.
  std::vector<FramePixel> all, half;
  for (int i = 0; i < 60 * 40; ++i) {
    all.push_back({std::uint16_t(i % 60), std::uint16_t(i / 60)});
    if (i % 60 < 30) half.push_back(all.back());
  }
  std::vector<FoundInHole> found;
  for (const FramePixel pixel : half) found.push_back({pixel, 0.1f, 0xff0000ffu, 0});
  // The threads' own memory, of the first calls of a program.
  for (int i = 0; i < 10; ++i) {
    HolePoints others;
    others.keep(camera, found);
    others.show(camera, all, included);
  }
  HolePoints points;
  points.take_memory(60, 40, 60 * 40 / 2);
  const std::size_t before = allocations_here;
  points.keep(camera, found);
  points.show(camera, all, included);
  found.clear();
  EXPECT_EQ(allocations_here - before, 0u);
  for (std::size_t hole = 0; hole < all.size(); ++hole)
    if (!points.shows(hole)) found.push_back({all[hole], 0.1f, 0xff0000ffu, 0});
  found.resize(std::min<std::size_t>(found.size(), 60 * 40 / 2));
  const std::size_t then = allocations_here;
  points.keep(camera, found);
  EXPECT_EQ(allocations_here - then, 0u);
  EXPECT_EQ(points.size(), half.size() + found.size());
  EXPECT_GT(points.size(), std::size_t(60 * 40) * 9 / 10);
}

}  // namespace
}  // namespace rilievo

#endif

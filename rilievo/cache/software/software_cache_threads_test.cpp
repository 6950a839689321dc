#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <optional>

#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// What a few frames of a walk look like, and what was drawn.
struct Walked {
  std::vector<Rgba8Image> colors;
  std::vector<Image<std::uint32_t>> objects;
  std::vector<double> bounds;  // pixels
  int pictures = 0, polygons = 0, captures = 0;
};

// `jump`: comes from the path's end, which it saw for two frames.
Walked walk_through(const BuiltinScene& made, int frames, ImageCacheOptions options = {},
                    bool jump = false) {
  Result<std::unique_ptr<TestSource>> cache = software_cache(made.scene, options);
  EXPECT_TRUE(cache.ok());
  const double end = made.path.keys.back().time;
  for (const double time : {end - 0.01, end})
    EXPECT_TRUE(!jump || (*cache)->draw(camera_at(made.path, time, 160, 90), 0).ok());
  Walked walked;
  for (int frame = 0; frame < frames; ++frame) {
    const double time = frame_time(made.path, frame);
    EXPECT_TRUE((*cache)->draw(camera_at(made.path, time, 160, 90), time).ok());
    EXPECT_TRUE((*cache)->draw_objects().ok());
    walked.colors.push_back((*cache)->software_target()->color());
    walked.objects.push_back((*cache)->software_target()->objects());
    const FrameStats& stats = (*cache)->stats();
    walked.bounds.push_back(stats.bound_px.value());
    walked.pictures += stats.groups + stats.count("nailboard");
    walked.polygons += stats.polygons;
    walked.captures += stats.captures;
  }
  return walked;
}

TEST(SoftwareCache, draws_the_same_bytes_with_any_number_of_threads) {
  const auto made = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(made.ok());
  const Walked together = walk_through(*made, 4);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const Walked alone = walk_through(*made, 4);
  EXPECT_EQ(together.colors, alone.colors);
  EXPECT_EQ(together.objects, alone.objects);
  EXPECT_GT(together.pictures, 4);
  EXPECT_GT(together.polygons, 4);
  EXPECT_GT(together.captures, 1);
}

// A machine's costs decide what is captured; the same costs, the same frames.
TEST(SoftwareCache, draws_the_same_bytes_with_the_costs_of_one_machine) {
  const auto made = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(made.ok());
  MachineCosts costs;
  costs.draw_software = {2000, 1, 500, 20, 10};
  costs.capture_rasterizer = {10000, 20, 60};
  costs.ray_texel_ns = 200;
  ImageCacheOptions options;
  options.machine = costs;
  const Walked cheap = walk_through(*made, 4, options);
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    const Walked alone = walk_through(*made, 4, options);
    EXPECT_EQ(cheap.colors, alone.colors);
    EXPECT_EQ(cheap.objects, alone.objects);
  }
  // Where triangles are a hundred times as dear, pictures are captured instead of polygons drawn.
  options.machine->draw_software.triangle_ns *= 100;
  const Walked dear = walk_through(*made, 4, options);
  EXPECT_LT(dear.polygons, cheap.polygons);
  EXPECT_GT(dear.captures, cheap.captures);
}

// Of the pixels of `truth`, how many show an object that `drawn` does not show within two pixels?
int missing_pixels(const Image<std::uint32_t>& truth, const Image<std::uint32_t>& drawn) {
  constexpr int kReach = 2;
  int missing = 0;
  for (int y = kReach; y < truth.height() - kReach; ++y)
    for (int x = kReach; x < truth.width() - kReach; ++x) {
      bool found = false;
      for (int v = y - kReach; v <= y + kReach; ++v)
        for (int u = x - kReach; u <= x + kReach; ++u) found |= drawn(u, v) == truth(x, y);
      missing += !found;
    }
  return missing;
}

// Where triangles take so long that the first frame may not draw them all.
TEST(SoftwareCache, draws_the_same_coarse_frames_with_any_number_of_threads_and_becomes_fine) {
  const auto made = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(made.ok());
  ImageCacheOptions options;
  options.machine = builtin_software_costs();
  options.machine->draw_software.triangle_ns = options.machine->capture_rasterizer.triangle_ns =
      5000;
  const Walked fine = walk_through(*made, 10, options, true);
  options.max_spike = 2;
  const Walked together = walk_through(*made, 10, options, true);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const Walked alone = walk_through(*made, 10, options, true);
  EXPECT_EQ(together.colors, alone.colors);
  EXPECT_EQ(together.objects, alone.objects);
  EXPECT_NE(together.colors.front(), fine.colors.front());
  // Texels of two pixels: half their diagonal less half a pixel's is sqrt(1/2), rounded up in size.
  EXPECT_GE(together.bounds.front(), std::sqrt(0.5) - 0.05);
  EXPECT_LE(together.bounds.back(), options.error_px);
  EXPECT_LE(fine.bounds.front(), options.error_px);
  // What is narrower than a texel may be between its rays: 1 % of the pixels.
  EXPECT_LT(missing_pixels(fine.objects.front(), together.objects.front()), 160 * 90 / 100);
  EXPECT_LT(missing_pixels(together.objects.front(), fine.objects.front()), 160 * 90 / 100);
}

TEST(SoftwareCache, keeps_to_its_memory_and_refuses_what_is_too_little) {
  const auto made = make_builtin("builtin:forest?triangles=200000");
  ASSERT_TRUE(made.ok());
  ImageCacheOptions options;
  options.max_bytes = std::size_t(1) << 20;
  EXPECT_FALSE(software_cache(made->scene, options).ok());
  options.max_bytes = std::size_t(128) << 20;
  Result<std::unique_ptr<TestSource>> cache = software_cache(made->scene, options);
  ASSERT_TRUE(cache.ok());
  for (int frame = 0; frame < 8; ++frame) {
    const double time = frame_time(made->path, 10 * frame);
    ASSERT_TRUE((*cache)->draw(camera_at(made->path, time, 160, 90), time).ok());
    EXPECT_LE((*cache)->stats().picture_bytes, options.max_bytes);
  }
  (*cache)->cache().invalidate();
  ASSERT_TRUE((*cache)->draw(camera_at(made->path, 0, 160, 90), 0).ok());
  EXPECT_EQ((*cache)->read_pictures().size(), (*cache)->cache().shown().size());
}

}  // namespace
}  // namespace rilievo

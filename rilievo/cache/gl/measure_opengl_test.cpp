#include "rilievo/cache/gl/measure_opengl.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"

#include <gtest/gtest.h>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/cache/software/measure_software.h"

namespace rilievo {
namespace {

using MeasureOpenGLTest = SceneTest;

MachineCosts measured_elsewhere() {
  MachineCosts costs;
  costs.draw_software = {2000, 1, 500, 200, 10};
  costs.capture_rasterizer = {10000, 20, 60};
  costs.ray_texel_ns = 200;
  return costs;
}

TEST_F(MeasureOpenGLTest, its_costs_can_be_stored_and_a_cache_uses_them) {
  MachineCosts costs = measured_elsewhere();
  const Result<> measured = measure_opengl(costs);
  ASSERT_TRUE(measured.ok()) << measured.error().message();
  EXPECT_TRUE(gl::check_errors("measuring").ok());
  ASSERT_TRUE(costs.draw_opengl && costs.capture_opengl);
  EXPECT_FALSE(costs.gl_renderer.empty());
  const Result<MachineCosts> stored = parse_machine(machine_json(costs), "stored");
  ASSERT_TRUE(stored.ok()) << stored.error().message();
  EXPECT_EQ(*stored, costs);

  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  const auto captures = [&](double triangle_ns) {
    ImageCacheOptions options;
    options.machine = *stored;
    options.machine->draw_opengl->triangle_ns = triangle_ns;
    auto cache = opengl_cache(*renderer, options);
    EXPECT_TRUE(cache.ok());
    int sum = 0;
    for (int frame = 0; frame < 3; ++frame) {
      frame_of(*cache, frame);
      sum += cache->stats().captures;
    }
    return sum;
  };
  EXPECT_GT(captures(1e5), captures(1));
}

TEST_F(MeasureOpenGLTest, polygons_alone_take_time_for_triangles_and_for_pixels) {
  for (const Result<PolygonTimes>& times :
       {measure_polygons_by_opengl(), measure_polygons_by_software()}) {
    ASSERT_TRUE(times.ok()) << times.error().message();
    EXPECT_GT(times->triangle_ns, 0);
    EXPECT_GT(times->pixel_ns, 0);
    EXPECT_DOUBLE_EQ(times->frame_ms(2e6, 3e6), 2 * times->triangle_ns + 3 * times->pixel_ns);
  }
  EXPECT_TRUE(gl::check_errors("measuring").ok());
}

TEST_F(MeasureOpenGLTest, a_cache_refuses_costs_that_were_measured_without_opengl) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  ImageCacheOptions options;
  options.machine = measured_elsewhere();
  const auto cache = opengl_cache(*renderer, options);
  ASSERT_FALSE(cache.ok());
  EXPECT_EQ(cache.error().where, "--machine");
}

}  // namespace
}  // namespace rilievo

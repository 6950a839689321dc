#include "rilievo/capture/raster_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rilievo/capture/placed_raster.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/source_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// From outside, all in front of the eye, or from within, where surfaces reach behind it.
Camera random_camera(const Box& box, Random& random, bool within) {
  const glm::dvec3 center(box.center());
  const double radius = double(box.radius());
  const float x = random.between(-1, 1), y = random.between(0.1f, 1), z = random.between(-1, 1);
  const glm::dvec3 out = glm::normalize(glm::dvec3(x, y, z));
  const glm::dvec3 eye = center + (within ? 0.3 : 1.3) * radius * out;
  return look_at(eye, eye - out + glm::dvec3(0, 0.2, 0), {0, 1, 0}, 0.9, 61, 47,
                 within ? 0.02 * radius : 0.3 * radius, 2.5 * radius);
}

TEST(RasterSource, captures_what_rays_capture) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built);
  const Scene& scene = built->scene;
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  const PlacedScene placed(scene);
  RaySource by_rays(*rays);
  RasterSource by_raster(placed);
  EXPECT_EQ(by_raster.bounds({}).min, by_rays.bounds({}).min);
  Random random(5);
  test_sources::Differences d;
  int hidden = 0;
  for (int round = 0; round < 24; ++round) {
    std::vector<std::uint32_t> objects;  // empty: all
    for (std::uint32_t i = 0; round % 3 && i < scene.objects.size(); ++i)
      if (random.below(2) == 0) objects.push_back(i);
    const Camera camera = random_camera(world_bounds(scene), random, round % 2);
    CaptureRequest request{.camera = camera, .objects = objects};
    request.samples = round % 4 < 2 ? 1 : 4;
    request.staggered = round % 8 < 2;
    request.farthest = !request.staggered;
    const auto a = by_raster.capture(request), b = by_rays.capture(request);
    ASSERT_TRUE(a) << a.error().message();
    ASSERT_TRUE(b) << b.error().message();
    ASSERT_TRUE(validate(a->picture));
    EXPECT_EQ(a->picture.name, b->picture.name);
    ASSERT_NO_FATAL_FAILURE(test_sources::count(*a, *b, d));
    for (std::size_t i = 0; i < a->farthest.texels().size(); ++i)
      hidden += a->farthest.texels()[i] > 1.01f * a->picture.depth.texels()[i];
  }
  EXPECT_GT(d.covered, 10'000);
  EXPECT_GT(hidden, 1000);
  // Where two triangles meet, and at outlines, rounding takes a sample to either.
  EXPECT_LE(d.objects, d.texels / 500);
  EXPECT_LE(d.depths, d.covered / 500);
  EXPECT_LE(d.farthest, d.texels / 500);
  EXPECT_LE(d.alphas, d.covered / 200);
  EXPECT_LE(d.colors, d.covered / 200);
}

// Pictures for atlases are the same pictures, encoded.
TEST(RasterSource, draws_what_it_captures) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built);
  const PlacedScene placed(built->scene);
  RasterSource source(placed);
  PlacedRaster raster(placed);
  Random random(6);
  int covered = 0;
  for (int round = 0; round < 6; ++round) {
    const Camera camera = random_camera(placed.opaque_bounds({}), random, false);
    std::vector<std::uint32_t> objects;
    placed.cull(camera, objects);
    const auto captured = source.capture({.camera = camera, .samples = 1, .farthest = true});
    ASSERT_TRUE(captured) << captured.error().message();
    const RasterPicture& drawn = raster.draw(camera, objects, 1);
    EXPECT_EQ(eye_z_from_window_z(drawn.depth, camera), captured->picture.depth);
    EXPECT_EQ(eye_z_from_window_z(raster.draw_farthest(camera, objects), camera),
              captured->farthest);
    const ObjectPicture& shown = raster.draw_objects(camera, objects);
    std::size_t i = 0;
    for (int y = camera.height - 1; y >= 0; --y)
      for (int x = 0; x < camera.width; ++x, ++i) {
        ASSERT_EQ(shown.object[i], captured->picture.object(x, y));
        if (shown.object[i] == kNoObject) continue;
        ++covered;
        const glm::vec4 linear = captured->picture.color(x, y);
        // Two ways of rounding to a byte.
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(255 * srgb_from_linear(std::min(linear[k], 1.0f)),
                      float(raster.picture().color[i][k]), 1);
      }
  }
  EXPECT_GT(covered, 3000);
}

TEST(RasterSource, what_it_cannot_do_is_refused) {
  const auto built = make_builtin("builtin:teapot?triangles=1000");
  ASSERT_TRUE(built);
  const PlacedScene placed(built->scene);
  RasterSource source(placed);
  Random random(1);
  Camera camera = random_camera(world_bounds(built->scene), random, false);
  const auto captured = source.capture({.camera = camera, .identifiers = false});
  ASSERT_TRUE(captured);
  EXPECT_TRUE(captured->picture.object.empty());
  EXPECT_TRUE(captured->farthest.empty());
  EXPECT_FALSE(source.capture({.camera = camera, .samples = 2}));
  EXPECT_FALSE(source.capture_layers({.camera = camera}));
  Camera other = camera;
  other.width = 5000;
  EXPECT_FALSE(source.capture({.camera = other}));
  other = camera;
  other.z_far = glm::length(camera.position() - glm::dvec3(world_bounds(built->scene).center()));
  EXPECT_TRUE(source.capture({.camera = other}));
  EXPECT_FALSE(source.capture({.camera = other, .farthest = true}));
  for (const Projection projection : {Projection::parallel, Projection::back_perspective}) {
    other = camera;
    other.projection = projection;
    EXPECT_FALSE(source.capture({.camera = other}));
  }
  camera.z_near = std::nan("");
  EXPECT_FALSE(source.capture({.camera = camera}));
}

}  // namespace
}  // namespace rilievo

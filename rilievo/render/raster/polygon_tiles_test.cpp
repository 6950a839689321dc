#include "rilievo/render/raster/polygon_tiles.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>

#include "rilievo/render/raster/raster_renderer.h"
#include "rilievo/render/software/sky_tiles.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

constexpr int kTilesWidth = 200, kTilesHeight = 113;  // of no tile's and no block's size

struct TileScene {
  BuiltinScene made;
  Camera camera;
  PlacedScene placed;
  std::vector<std::uint32_t> objects;

  explicit TileScene(const char* spec)
      : made(std::move(*make_builtin(spec))),
        camera(camera_at(made.path, 1, kTilesWidth, kTilesHeight)),
        placed(made.scene) {
    placed.cull(camera, objects);
  }
};

TEST(PolygonTiles, show_what_the_rasteriser_draws) {
  const TileScene scene("builtin:teapots?triangles=20000");
  for (const int samples : {1, 4}) {
    PolygonTiles tiles(scene.made.scene);
    ASSERT_TRUE(tiles.place(scene.camera, samples, scene.placed, scene.objects, {}).ok());
    SoftwareTarget target(kTilesWidth, kTilesHeight, samples);
    const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
    target.draw(scene.camera.z_far, drawers);
    const Image<float> eye_z = target.eye_z();

    RasterRenderer renderer(scene.made.scene);
    RasterPicture picture;
    ObjectPicture objects;
    ASSERT_TRUE(renderer.draw(scene.camera, samples, picture).ok());
    ASSERT_TRUE(renderer.draw_objects(scene.camera, objects).ok());
    ASSERT_TRUE(tiles.place_objects(scene.camera, scene.placed, scene.objects, {}).ok());
    target.draw_objects(scene.camera.z_far, drawers);
    int shown = 0;
    for (int y = 0; y < kTilesHeight; ++y)
      for (int x = 0; x < kTilesWidth; ++x) {
        const std::size_t i = std::size_t(kTilesHeight - 1 - y) * kTilesWidth + std::size_t(x);
        // Four bytes are rounded, then their average; there their average alone.
        for (int c = 0; c < 4; ++c)
          ASSERT_LE(std::abs(target.color()(x, y)[c] - picture.color[i][c]), 1) << x << " " << y;
        ASSERT_EQ(target.objects()(x, y), objects.object[i]);
        if (samples > 1) continue;
        const bool empty = picture.depth[i] >= 1;
        ASSERT_EQ(eye_z(x, y) == kNoDepth, empty);
        if (empty) continue;
        ++shown;
        const double n = 1 / scene.camera.z_near, f = 1 / scene.camera.z_far;
        ASSERT_NEAR(eye_z(x, y), 1 / (n - double(picture.depth[i]) * (n - f)), 1e-3);
      }
    if (samples == 1) {
      EXPECT_GT(shown, 2000);
    }
  }
}

TEST(PolygonTiles, objects_that_fade_share_the_pixels_by_their_hash) {
  const TileScene scene("builtin:teapot?triangles=5000");
  const auto frame_with = [&](std::span<const std::uint32_t> objects,
                              std::span<const CrossFade> fading) {
    PolygonTiles tiles(scene.made.scene);
    EXPECT_TRUE(tiles.place(scene.camera, 1, scene.placed, objects, fading).ok());
    SoftwareTarget target(kTilesWidth, kTilesHeight, 1);
    const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
    target.draw(scene.camera.z_far, drawers);
    return target.color();
  };
  const Rgba8Image whole = frame_with(scene.objects, {});
  const std::uint32_t object = scene.objects.front();
  const CrossFade part[] = {{object, 0.0f, 0.3f}},
                  both[] = {{object, 0.0f, 0.3f}, {object, 0.3f, 1.0f}};
  const Rgba8Image some = frame_with({}, part);
  EXPECT_EQ(frame_with({}, both), whole);
  int drawn = 0, all = 0;
  for (int y = 0; y < kTilesHeight; ++y)
    for (int x = 0; x < kTilesWidth; ++x) {
      if (whole(x, y).a == 0) continue;
      ++all;
      const auto fract = [](float a) { return a - std::floor(a); };
      const auto row = float(kTilesHeight - 1 - y);
      const float hash = fract(52.9829189f * fract(float(x) * 0.06711056f + row * 0.00583715f));
      EXPECT_EQ(some(x, y), hash < 0.3f ? whole(x, y) : glm::u8vec4(0));
      drawn += some(x, y).a != 0;
    }
  EXPECT_NEAR(double(drawn) / all, 0.3, 0.03);
}

// Identifiers are taken at centres, colours with four samples: a pixel that shows an object shades
// at least one triangle of it.
TEST(PolygonTiles, count_what_each_object_took) {
  const TileScene scene("builtin:teapots?triangles=20000");
  PolygonTiles tiles(scene.made.scene);
  SoftwareTarget target(kTilesWidth, kTilesHeight, 4);
  const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
  ASSERT_TRUE(tiles.place_objects(scene.camera, scene.placed, scene.objects, {}).ok());
  target.draw_objects(scene.camera.z_far, drawers);
  std::map<std::uint32_t, std::uint64_t> pixels;
  for (const std::uint32_t object : target.objects().texels())
    if (object != kNoObject) ++pixels[object - 1];
  std::vector<ObjectWork> first;
  for (const int threads : {1, 2, 3}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    ASSERT_TRUE(tiles.place(scene.camera, 4, scene.placed, scene.objects, {}).ok());
    target.draw(scene.camera.z_far, drawers);
    const std::vector<ObjectWork> work(tiles.work().begin(), tiles.work().end());
    ASSERT_EQ(work.size(), scene.objects.size());
    std::uint64_t shaded = 0, seen = 0;
    for (const ObjectWork& one : work) {
      const Object& object = scene.made.scene.objects[one.object];
      EXPECT_LE(one.filled, one.projected);
      EXPECT_LE(one.projected, scene.made.scene.models[std::size_t(object.model)].triangles);
      EXPECT_GE(one.shaded, pixels[one.object]) << one.object;
      shaded += one.shaded, seen += pixels[one.object];
    }
    EXPECT_GT(seen, 2000u);
    EXPECT_LT(shaded, 8 * seen);  // four samples, and edges beyond the centres
    if (first.empty()) first = work;
    for (std::size_t i = 0; i < work.size(); ++i) {
      EXPECT_EQ(work[i].object, first[i].object);
      EXPECT_EQ(work[i].projected, first[i].projected);
      EXPECT_EQ(work[i].filled, first[i].filled);
      EXPECT_EQ(work[i].shaded, first[i].shaded);
    }
  }
}

TEST(SkyTiles, show_the_sky_s_colour_where_nothing_is) {
  const Sky sky;
  const Camera camera =
      look_at({0, 2, 0}, {3, 2.2, -4}, {0, 1, 0}, 1.4, kTilesWidth, kTilesHeight, 0.1, 100);
  SkyTiles tiles(sky);
  tiles.place(camera);
  SoftwareTarget target(kTilesWidth, kTilesHeight, 4);
  const TileDrawer* drawers[] = {&tiles};
  target.draw(camera.z_far, drawers);
  for (int y = 0; y < kTilesHeight; ++y)
    for (int x = 0; x < kTilesWidth; ++x) {
      const glm::dvec3 to = world_from_raster(camera, {x + 0.5, y + 0.5}, 1) - camera.position();
      const auto elevation = float(glm::normalize(to).y);
      const glm::vec3 above =
          glm::mix(sky.horizon, sky.zenith, std::sqrt(glm::clamp(elevation, 0.0f, 1.0f)));
      const float t = glm::clamp(elevation / -0.08f, 0.0f, 1.0f);
      const glm::vec3 color = glm::mix(above, sky.ground, t * t * (3 - 2 * t));
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(target.color()(x, y)[c], 255 * srgb_from_linear(color[c]), 1.1);
      ASSERT_EQ(target.color()(x, y).a, 255);
    }
}

}  // namespace
}  // namespace rilievo

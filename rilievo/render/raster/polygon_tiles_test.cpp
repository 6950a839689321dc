#include "rilievo/render/raster/polygon_tiles.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "rilievo/render/raster/whole_frames_test_helpers.h"
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

// A frame of one sample a pixel.
Rgba8Image frame_of(const Scene& scene, const PlacedScene& placed, const Camera& camera,
                    std::span<const std::uint32_t> objects, std::span<const CrossFade> fading) {
  PolygonTiles tiles(scene);
  EXPECT_TRUE(tiles.place(camera, 1, placed, objects, fading).ok());
  SoftwareTarget target(kTilesWidth, kTilesHeight, 1);
  const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
  target.draw(camera.z_far, drawers);
  return target.color();
}

// At how many pixels' centres is each object seen?
std::map<std::uint32_t, std::uint64_t> pixels_by_object(PolygonTiles& tiles, const TileScene& scene,
                                                        SoftwareTarget& target) {
  EXPECT_TRUE(tiles.place_objects(scene.camera, scene.placed, scene.objects, {}).ok());
  const TileDrawer* drawers[] = {&tiles};
  target.draw_objects(scene.camera.z_far, drawers);
  std::map<std::uint32_t, std::uint64_t> pixels;
  for (const std::uint32_t object : target.objects().texels())
    if (object != kNoObject) ++pixels[object - 1];
  return pixels;
}

TEST(PolygonTiles, show_what_the_rasteriser_draws) {
  const TileScene scene("builtin:teapots?triangles=20000");
  for (const int samples : {1, 4}) {
    PolygonTiles tiles(scene.made.scene);
    ASSERT_TRUE(tiles.place(scene.camera, samples, scene.placed, scene.objects, {}).ok());
    SoftwareTarget target(kTilesWidth, kTilesHeight, samples);
    const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
    target.draw(scene.camera.z_far, drawers);
    const Image<float> eye_z = target.eye_z();

    RasterFrames renderer(scene.made.scene);
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

// A few objects are looked for only where their bounds lie in the frame.
TEST(PolygonTiles, few_objects_are_found_wherever_they_lie) {
  TileScene scene("builtin:teapots?triangles=20000");
  std::mt19937 random(5);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  std::size_t covered = 0, frames = 0;
  for (const float away : {0.0f, 20000.0f}) {
    for (Object& object : scene.made.scene.objects)
      object.placement[3] += glm::vec4(away, 0, -away, 0);
    scene.placed = PlacedScene(scene.made.scene);
    const glm::dvec3 moved(away, 0, -away);
    for (int i = 0; i < 40; ++i) {
      Camera camera = camera_at(scene.made.path, between(0, 8), kTilesWidth, kTilesHeight);
      camera.world_from_eye[3] += glm::dvec4(moved, 0);
      camera.world_from_eye =
          glm::rotate(camera.world_from_eye, between(-1, 1), glm::dvec3(0.3, 1, 0.2));
      std::vector<std::uint32_t> few;
      for (int k = 0; k < 1 + i % 3; ++k)
        few.push_back(std::uint32_t(random() % scene.placed.bounds().size()));
      std::ranges::sort(few);
      few.erase(std::unique(few.begin(), few.end()), few.end());
      const int samples = i % 2 ? 4 : 1;
      PolygonTiles tiles(scene.made.scene);
      ASSERT_TRUE(tiles.place(camera, samples, scene.placed, few, {}).ok());
      Image<float> cover(kTilesWidth, kTilesHeight, 7.0f);
      tiles.find_cover(camera, cover);
      SoftwareTarget target(kTilesWidth, kTilesHeight, samples);
      const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
      target.draw(camera.z_far, drawers);

      FrameRaster raster(scene.made.scene);
      ASSERT_TRUE(raster.find_visible(camera, samples, scene.placed, few, {}).ok());
      std::size_t any = 0;
      for (int y = 0; y < kTilesHeight; ++y)
        for (int x = 0; x < kTilesWidth; ++x) {
          const float* depths =
              raster.seen().depths(kTilesHeight - 1 - y) + std::ptrdiff_t(x) * samples;
          const auto shown = std::count_if(depths, depths + samples, [](float d) { return d < 1; });
          ASSERT_EQ(cover(x, y) > 0, shown == samples) << x << " " << y;
          ASSERT_EQ(target.color()(x, y).a > 0, shown > 0) << x << " " << y;
          any += shown > 0;
        }
      covered += any, frames += any > 0;
    }
  }
  EXPECT_GT(frames, 15u);
  EXPECT_GT(covered, 3000u);
}

TEST(PolygonTiles, objects_that_fade_share_the_pixels_by_their_hash) {
  const TileScene scene("builtin:teapot?triangles=5000");
  const auto frame_with = [&](std::span<const std::uint32_t> objects,
                              std::span<const CrossFade> fading) {
    return frame_of(scene.made.scene, scene.placed, scene.camera, objects, fading);
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
  auto pixels = pixels_by_object(tiles, scene, target);
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

// Of one sample a pixel, each that shows an object is shaded once.
TEST(PolygonTiles, shade_as_many_pixels_of_an_object_as_show_it) {
  const TileScene scene("builtin:teapots?triangles=20000");
  PolygonTiles tiles(scene.made.scene);
  SoftwareTarget target(kTilesWidth, kTilesHeight, 1);
  const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
  auto pixels = pixels_by_object(tiles, scene, target);
  ASSERT_TRUE(tiles.place(scene.camera, 1, scene.placed, scene.objects, {}).ok());
  target.draw(scene.camera.z_far, drawers);
  for (const ObjectWork& one : tiles.work()) EXPECT_EQ(one.shaded, pixels[one.object]);
  EXPECT_GT(pixels.size(), 8u);
}

// An object for each quad that faces +z, or one with all of them as parts; of several materials.
struct Quad {
  float x0, x1, y0, y1, z;
  AlphaMode mode = AlphaMode::opaque;
};
Scene quads_of(std::span<const Quad> quads, bool together) {
  Scene scene;
  for (const Quad& quad : quads) {
    Mesh mesh;
    for (const glm::vec2 at :
         {glm::vec2(quad.x0, quad.y0), {quad.x1, quad.y0}, {quad.x1, quad.y1}, {quad.x0, quad.y1}})
      mesh.positions.emplace_back(at, quad.z), mesh.normals.emplace_back(0, 0, 1);
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.material = int(scene.materials.size());
    Material& material = scene.materials.emplace_back();
    material.unlit = true, material.alpha_mode = quad.mode;
    material.base_color = glm::vec4(0.1f * float(mesh.material + 1), 0.5f, 0.9f,
                                    quad.mode == AlphaMode::blend ? 0.5f : 1.0f);
    if (scene.models.empty() || !together) {
      scene.models.emplace_back();
      scene.objects.emplace_back().model = int(scene.models.size()) - 1;
    }
    scene.models.back().parts.push_back({int(scene.meshes.size()), glm::mat4(1)});
    scene.meshes.push_back(std::move(mesh));
  }
  finish(scene);
  return scene;
}

std::vector<ObjectWork> work_of_frame(const Scene& scene, const Camera& camera) {
  const PlacedScene placed(scene);
  std::vector<std::uint32_t> objects;
  placed.cull(camera, objects);
  PolygonTiles tiles(scene);
  EXPECT_TRUE(tiles.place(camera, 4, placed, objects, {}).ok());
  SoftwareTarget target(camera.width, camera.height, 4);
  const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
  target.draw(camera.z_far, drawers);
  return {tiles.work().begin(), tiles.work().end()};
}

// Side by side, so that none hides another.
TEST(PolygonTiles, count_of_an_object_what_each_of_its_parts_took) {
  const Quad quads[] = {{-3, -1.1f, -1, 1, 0}, {-1, 1, -1, 1, 0}, {1.1f, 3, -1, 1, 0}};
  const Camera camera =
      look_at({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 1, kTilesWidth, kTilesHeight, 1, 9);
  const std::vector<ObjectWork> parts = work_of_frame(quads_of(quads, false), camera),
                                whole = work_of_frame(quads_of(quads, true), camera);
  ASSERT_EQ(parts.size(), 3u);
  ASSERT_EQ(whole.size(), 1u);
  ObjectWork sum;
  for (const ObjectWork& one : parts) {
    EXPECT_EQ(one.filled, 2u);
    sum.projected += one.projected, sum.filled += one.filled, sum.shaded += one.shaded;
  }
  EXPECT_EQ(whole[0].projected, sum.projected);
  EXPECT_EQ(whole[0].filled, sum.filled);
  EXPECT_EQ(whole[0].shaded, sum.shaded);
}

// All triangles of a floor that reaches behind the eye are cut, and no piece of them is free.
TEST(PolygonTiles, count_what_is_cut_at_the_near_plane) {
  const Quad floor[] = {{-5, 5, -20, 20, 0}};
  const Camera camera =
      look_at({0.5, 0.3, 1}, {0.3, 8, 0}, {0, 0, 1}, 1, kTilesWidth, kTilesHeight, 0.1, 50);
  const std::vector<ObjectWork> work = work_of_frame(quads_of(floor, false), camera);
  ASSERT_EQ(work.size(), 1u);
  EXPECT_GT(work[0].shaded, 5000u);
  EXPECT_GE(work[0].projected, 2u);
  EXPECT_GE(work[0].filled, 2u);
}

// Runs of triangles that lie on one side of the near plane are passed over as a whole; those after
// them are cut even so. The eye stands low over the first triangles of runs, with the run before
// behind it.
TEST(PolygonTiles, a_mesh_of_many_runs_is_cut_as_one_of_none) {
  constexpr int kSide = 64;
  Scene scene;
  Mesh mesh;
  for (int z = 0; z <= kSide; ++z)
    for (int x = 0; x <= kSide; ++x) mesh.positions.emplace_back(x, 0.1f * float((x + z) % 2), z);
  for (int z = 0; z < kSide; ++z)
    for (int x = 0; x < kSide; ++x)
      for (const int corner : {0, kSide + 1, 1, 1, kSide + 1, kSide + 2})
        mesh.indices.push_back(std::uint32_t(z * (kSide + 1) + x + corner));
  mesh.material = 0;
  scene.materials.emplace_back().unlit = true;
  scene.meshes.push_back(mesh);
  scene.models.emplace_back().parts.push_back({0, glm::mat4(1)});
  scene.objects.emplace_back();
  finish(scene);
  Scene whole = scene;
  whole.meshes[0].run_bounds.clear();
  const auto eye_z_of = [](const Scene& from, const Camera& camera) {
    const PlacedScene placed(from);
    PolygonTiles tiles(from);
    const std::uint32_t object = 0;
    EXPECT_TRUE(tiles.place(camera, 1, placed, {&object, 1}, {}).ok());
    SoftwareTarget target(kTilesWidth, kTilesHeight, 1);
    const TileDrawer* drawers[] = {&tiles, &tiles.shading()};
    target.draw(camera.z_far, drawers);
    return target.eye_z();
  };
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> u(0, 1);
  ASSERT_GT(scene.meshes[0].run_bounds.size(), 4u);
  for (std::size_t run = 1; run < scene.meshes[0].run_bounds.size(); ++run)
    for (int i = 0; i < 10; ++i) {
      const double row = double(run) * Mesh::kRun / 2 / kSide;
      const glm::dvec3 eye(0.4 * u(rng), 0.3 + 0.1 * u(rng), row + 0.2 + 0.3 * u(rng));
      const Camera camera = look_at(eye, eye + glm::dvec3(0, -1, 1), {0, 1, 0}, 1.5, kTilesWidth,
                                    kTilesHeight, 0.3, 99);
      ASSERT_EQ(eye_z_of(scene, camera), eye_z_of(whole, camera)) << run;
    }
}

// Blended parts are drawn later, and have no share of the list of those that fade here.
TEST(PolygonTiles, objects_with_blended_parts_fade_as_others_do) {
  const Quad quads[] = {
      {-3, -0.1f, -1, 1, 0}, {-2, 2, -0.5f, 0.5f, 1, AlphaMode::blend}, {0.1f, 3, -1, 1, 0}};
  const Camera camera =
      look_at({0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 1, kTilesWidth, kTilesHeight, 1, 9);
  Scene scene = quads_of(quads, true);
  // The same behind itself, which does not fade.
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].placement = glm::translate(glm::mat4(1), {0, 1, -1});
  finish(scene);
  const PlacedScene placed(scene);
  const auto frame_with = [&](std::span<const std::uint32_t> objects,
                              std::span<const CrossFade> fading) {
    return frame_of(scene, placed, camera, objects, fading);
  };
  const std::uint32_t both[] = {0, 1}, behind[] = {1};
  const CrossFade halves[] = {{0, 0.0f, 0.5f}, {0, 0.5f, 1.0f}}, half[] = {{0, 0.0f, 0.5f}};
  const Rgba8Image whole = frame_with(both, {});
  EXPECT_EQ(frame_with(behind, halves), whole);
  EXPECT_NE(frame_with(behind, half), whole);
}

// What is drawn between over one sample of each pixel stays, also where the polygon's triangle goes
// on beside it.
TEST(PolygonTiles, samples_that_something_nearer_hides_are_left_alone) {
  constexpr std::uint32_t kCover = 0xff00ff00u;
  struct Cover final : TileDrawer {
    void draw_tile(FrameTile& tile) const override {
      for (int block = 0; block < FrameTile::kBlockCount; ++block) {
        tile.expand(block);
        tile.changed[block] = true;
        for (int i = 0; i < FrameTile::kBlockPixels; ++i)
          tile.plane(block, i % 4).content[i] = kCover,
                                tile.plane(block, i % 4).inverse_z[i] = 1e6f;
      }
    }
  };
  struct Check final : TileDrawer {
    void draw_tile(FrameTile& tile) const override {
      for (int block = 0; block < FrameTile::kBlockCount; ++block)
        for (int i = 0; i < FrameTile::kBlockPixels; ++i)
          for (int s = 0; s < 4; ++s)
            EXPECT_EQ(tile.plane(block, s).content[i] == kCover, s == i % 4) << block << " " << i;
    }
  };
  const TileScene scene("builtin:teapots?triangles=20000");
  PolygonTiles tiles(scene.made.scene);
  ASSERT_TRUE(tiles.place(scene.camera, 4, scene.placed, scene.objects, {}).ok());
  SoftwareTarget target(kTilesWidth, kTilesHeight, 4);
  const Cover cover;
  const Check check;
  const TileDrawer* drawers[] = {&tiles, &cover, &tiles.shading(), &check};
  target.draw(scene.camera.z_far, drawers);
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

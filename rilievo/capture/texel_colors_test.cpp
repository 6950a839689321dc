// The texel rule in the sources that need no OpenGL.
#include <gtest/gtest.h>

#include <memory>

#include "rilievo/capture/photograph_source.h"
#include "rilievo/capture/plate_test_helpers.h"
#include "rilievo/capture/raster_source.h"
#include "rilievo/capture/ray_source.h"

namespace rilievo {
namespace {

using namespace test_plate;

struct Sources {
  explicit Sources(const Scene& scene)
      : rays(RayScene::create(scene)), placed(std::make_unique<PlacedScene>(scene)) {
    by_rays = std::make_unique<RaySource>(*rays);
    raster = std::make_unique<RasterSource>(*placed);
  }
  Result<RayScene> rays;
  std::unique_ptr<PlacedScene> placed;
  std::unique_ptr<CaptureSource> by_rays, raster;
};

TEST(TexelColors, are_those_of_the_surface_whose_depth_a_texel_has) {
  Random random(1);
  int edges = 0;
  for (int round = 0; round < 12; ++round) {
    const Scene scene = plate(random, round % 2);
    Sources sources(scene);
    const Camera camera = plate_camera(random, 90);
    for (CaptureSource* const source : {sources.by_rays.get(), sources.raster.get()}) {
      const auto captured = source->capture({.camera = camera, .with_sky = round % 3 == 0});
      ASSERT_TRUE(captured) << captured.error().message();
      const DepthImage& picture = captured->picture;
      for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 90; ++x) {
          if (!picture.covered(x, y)) continue;
          const bool red = is_plate(camera, {x + 0.5, y + 0.5}, picture.depth(x, y));
          ASSERT_LT(off_surface(picture, x, y), 1e-5f) << round << ' ' << x << ' ' << y;
          edges += x > 0 && picture.covered(x - 1, y) &&
                   red != is_plate(camera, {x - 0.5, y + 0.5}, picture.depth(x - 1, y));
        }
    }
  }
  EXPECT_GT(edges, 500);
}

// The lens of a photograph has mixed what is at edges.
TEST(TexelColors, of_photographs_are_unmixed) {
  constexpr int kSize = 80, kFine = 4;
  Random random(2);
  int mixed = 0;
  for (int round = 0; round < 6; ++round) {
    const Scene scene = plate(random, false);
    Sources sources(scene);
    const Camera camera = plate_camera(random, kSize);
    Camera fine = camera;
    fine.width = fine.height = kSize * kFine;
    DepthImage photograph = sources.by_rays->capture({.camera = camera, .samples = 1})->picture;
    const DepthImage all = sources.by_rays->capture({.camera = fine, .samples = 1})->picture;
    photograph.object = {};
    const auto color_of = [&](int x, int y) {
      glm::vec4 sum(0);
      for (int i = 0; i < kFine * kFine; ++i)
        sum += all.color(kFine * x + i % kFine, kFine * y + i / kFine);
      return sum / float(kFine * kFine);
    };
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x)
        if (photograph.covered(x, y)) {
          const glm::vec4 color = color_of(x, y);
          if (color.a == 1) photograph.color(x, y) = color;
        }
    const PhotographSource source("plate", {photograph});
    const DepthImage& unmixed = source.photographs()[0];
    for (int y = 1; y + 1 < kSize; ++y)
      for (int x = 1; x + 1 < kSize; ++x) {
        if (!photograph.covered(x, y)) continue;
        const bool red = is_plate(camera, {x + 0.5, y + 0.5}, photograph.depth(x, y));
        mixed += off_color(photograph.color(x, y), red) > 0.1f;
        ASSERT_LT(off_surface(unmixed, x, y), 1e-3f) << round << ' ' << x << ' ' << y;
      }
    // The warp of photographs into other pictures mixes nothing either.
    PhotographSource warped("plate", {photograph});
    const auto elsewhere = warped.capture({.camera = plate_camera(random, kSize)});
    ASSERT_TRUE(elsewhere);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const DepthImage& picture = elsewhere->picture;
        if (!picture.covered(x, y)) continue;
        const bool red = is_plate(picture.camera, {x + 0.5, y + 0.5}, picture.depth(x, y));
        // Edges in front are as wide as texels of the photograph.
        if (red) continue;
        ASSERT_LT(off_color(picture.color(x, y), red), 1e-3f) << round << ' ' << x << ' ' << y;
      }
  }
  EXPECT_GT(mixed, 100);
}

// Wires of which a texel's centre sees something and no sample does, and the other way round.
TEST(TexelColors, of_thin_wires_are_never_black_and_leave_no_gap) {
  Scene scene;
  Material material;
  material.base_color = {1, 0, 0, 1};
  material.unlit = material.double_sided = true;
  scene.materials = {material};
  // Half a texel of 0.04 m wide.
  Mesh wire;
  wire.positions = {{-2, -0.01f, 0}, {2, -0.01f, 0}, {2, 0.01f, 0}, {-2, 0.01f, 0}};
  wire.indices = {0, 1, 2, 0, 2, 3};
  wire.material = 0;
  scene.meshes = {wire};
  scene.models = {{"wire", {{0, glm::mat4(1)}}, {}, 0}};
  Random random(3);
  for (int round = 0; round < 12; ++round) {
    scene.objects.resize(1);
    const float turn = random.between(-0.7f, 0.7f);
    scene.objects[0].placement = glm::rotate(
        glm::translate(glm::mat4(1), {0, random.between(-0.1f, 0.1f), 0}), turn, {0, 0, 1});
    finish(scene);
    Sources sources(scene);
    Camera camera = look_at({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.9273, 100, 100, 0.1, 20);
    for (CaptureSource* const source : {sources.by_rays.get(), sources.raster.get()}) {
      const auto captured = source->capture({.camera = camera, .farthest = true});
      ASSERT_TRUE(captured) << captured.error().message();
      const DepthImage& picture = captured->picture;
      int last = -1;
      for (int x = 20; x < 80; ++x) {
        int here = -1, count = 0;
        for (int y = 0; y < 100; ++y) {
          if (!picture.covered(x, y)) continue;
          here = y, ++count;
          ASSERT_LT(off_color(picture.color(x, y), true), 1e-5f);
          ASSERT_NEAR(picture.depth(x, y), 4, 1e-3);
          ASSERT_EQ(picture.object(x, y), 1u);
          ASSERT_GE(captured->farthest(x, y), picture.depth(x, y) * 0.999f);
          ASSERT_NE(captured->farthest(x, y), kNoDepth);
        }
        ASSERT_GE(count, 1) << "round " << round << ", column " << x;
        ASSERT_LE(count, 2);
        if (last >= 0) {
          ASSERT_LE(std::abs(here - last), 2);
        }
        last = here;
      }
    }
  }
}

}  // namespace
}  // namespace rilievo

// What do textures of one layer lack that one layered texture has? (the paper's chimney)
//
// An object that hides parts of itself, seen from beside: texels that stay empty where there is
// something (uncovered), and texels that show what something else hides (wrong visibility). One
// relief texture, six around the object of which the best is shown, one layered relief texture.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "rilievo/layered_relief/relief_set.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo {
namespace {

struct Shares {
  double uncovered = 0, wrong = 0;  // of the texels that show something
  [[nodiscard]] double sum() const { return uncovered + wrong; }
};

struct Chimney {
  Shares one, six, layered;
};

ReliefSet reliefs_of(const RayScene& rays, std::span<const glm::dvec3> directions, int layers) {
  ReliefSet set;
  const Box box = world_bounds(rays.scene());
  for (const glm::dvec3& direction : directions) {
    const Result<Camera> camera = relief_camera(box, direction, 96);
    Result<LayeredRelief> relief = build_layered_relief(
        cast_layers(rays, *camera, {.merge = 0.01 * texel_angle(*camera), .max_layers = layers}));
    if (relief) set.reliefs.push_back(*std::move(relief));
  }
  return set;
}

Shares shares_of(const RayScene& rays, const ReliefSet& set) {
  const Box box = world_bounds(rays.scene());
  const glm::dvec3 center(box.center());
  const double radius = double(box.radius());
  double shown = 0, uncovered = 0, wrong = 0;
  for (int e = 0; e < 12; ++e) {
    // 14, 33 and 52 degrees beside the front.
    const double turn = 2 * M_PI * e / 12, tilt = 0.25 + 0.65 * (e % 3) / 2.0;
    const glm::dvec3 eye = center + 4 * radius *
                                        glm::dvec3(std::sin(tilt) * std::cos(turn),
                                                   std::sin(tilt) * std::sin(turn), std::cos(tilt));
    const int picked = pick_relief(set, eye);
    if (picked < 0) continue;
    const LayeredRelief& relief = set.reliefs[std::size_t(picked)];
    Prewarp prewarp(relief, {.splat_size = 1.5});
    Prewarped result;
    if (!prewarp.warp(eye, nullptr, result)) continue;
    const Camera& camera = result.geometry.capture;
    const DepthImage truth = cast_picture(rays, camera);
    // A few texels of depth: where it is steep.
    const double tolerance = 4 * glm::length(relief.frame().a) + 0.01 * radius;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        if (!truth.covered(x, y)) continue;
        ++shown;
        const std::uint16_t delta =
            result.delta[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)];
        if (delta == kEmptyCode) {
          ++uncovered;
          continue;
        }
        const double z = eye_z_from(DepthKind::window_z, double(decode_delta(delta, 16)), camera,
                                    {x + 0.5, y + 0.5});
        wrong += std::abs(z - double(truth.depth(x, y))) > tolerance;
      }
  }
  return {uncovered / shown, wrong / shown};
}

Chimney chimney(const Scene& scene) {
  const Result<RayScene> rays = RayScene::create(scene);
  const std::vector<glm::dvec3> front = {{0, 0, 1}};
  const std::vector<glm::dvec3> around = *relief_directions(6);
  return {shares_of(*rays, reliefs_of(*rays, front, 1)),
          shares_of(*rays, reliefs_of(*rays, around, 1)),
          shares_of(*rays, reliefs_of(*rays, front, 256))};
}

void print(const char* name, const Chimney& c) {
  if (!std::getenv("RILIEVO_SHOW")) return;
  for (const auto& [way, shares] :
       {std::pair("one", c.one), std::pair("six", c.six), std::pair("layered", c.layered)})
    std::printf("%-14s %-8s uncovered %.2f %%, wrong %.2f %%\n", name, way, 100 * shares.uncovered,
                100 * shares.wrong);
}

TEST(ChimneyTest, one_layered_texture_of_a_fern_lacks_less_than_six_of_one_layer) {
  const auto built = make_builtin("builtin:fern?triangles=16000");
  ASSERT_TRUE(built);
  const Chimney c = chimney(built->scene);
  print("fern", c);
  EXPECT_LT(c.layered.sum(), 0.5 * c.one.sum());
  EXPECT_LT(c.layered.sum(), 0.7 * c.six.sum());
  EXPECT_LT(c.layered.uncovered, 0.5 * c.one.uncovered);
}

TEST(ChimneyTest, so_does_that_of_a_model_with_an_interior) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const auto scene =
      load_scene(std::filesystem::path(data) / "models/FlightHelmet/FlightHelmet.gltf");
  ASSERT_TRUE(scene) << scene.error().message();
  const Chimney c = chimney(scene->scene);
  print("FlightHelmet", c);
  // Through cracks its inner sides show, where one layer shows nothing.
  EXPECT_LT(c.layered.sum(), 0.85 * c.one.sum());
}

}  // namespace
}  // namespace rilievo

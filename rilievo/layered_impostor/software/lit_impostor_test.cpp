// Layered impostors of the ray tracer's light, at a small size.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shaders/lit_source.h"
#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/layered_impostor/bake.h"
#include "rilievo/layered_impostor/warp.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo {
namespace {

constexpr int kTexels = 64, kPixels = 64, kEyes = 4;

// dB of what an impostor shows to eyes between its views against what the tracer sees from there:
// of one that has its light, and of one by rays, without shadows. Means of all eyes.
struct TracerDb {
  double lit = 0, by_rays = 0, worst_lit = 1e9;
};

TracerDb shown_by_impostors(const Scene& scene) {
  Result<RayScene> opaque = RayScene::create(scene),
                   all = RayScene::create(scene, 0, RayParts::all);
  EXPECT_TRUE(opaque && all);
  if (!opaque || !all) return {};
  RaySource rays(*opaque);
  RayTracer tracer(*all);
  LitSource light(rays, tracer, {.samples = 8}), truth_source(rays, tracer, {.samples = 32});
  BakeOptions options;
  options.camera.size = kTexels;
  const Result<LayeredImpostor> lit = bake_layered(light, {}, options),
                                plain = bake_layered(rays, {}, options);
  EXPECT_TRUE(lit && plain);
  if (!lit || !plain) return {};
  const glm::dvec3 center(lit->bounds.center());
  const double radius = double(lit->bounds.radius());
  TracerDb shown;
  for (int i = 0; i < kEyes; ++i) {
    const double turn = 0.4 + 2 * M_PI * i / kEyes;
    const glm::dvec3 aside(std::cos(turn), 0.15 + 0.2 * i, std::sin(turn));
    const Camera camera = look_at(center + 3 * radius * glm::normalize(aside), center, {0, 1, 0},
                                  0.7, kPixels, kPixels, 0.5 * radius, 8 * radius);
    const Result<CapturedPicture> truth = truth_source.capture({.camera = camera, .samples = 32});
    EXPECT_TRUE(truth);
    if (!truth) return {};
    const auto db = [&](const LayeredImpostor& impostor) {
      return psnr_db(srgb8_from_linear(truth->picture.color),
                     srgb8_from_linear(warp_surfaces(impostor, camera).color));
    };
    const double with = db(*lit);
    shown.lit += with / kEyes, shown.by_rays += db(*plain) / kEyes;
    shown.worst_lit = std::min(shown.worst_lit, with);
  }
  testing::Test::RecordProperty("lit_db", std::to_string(shown.lit));
  testing::Test::RecordProperty("by_rays_db", std::to_string(shown.by_rays));
  testing::Test::RecordProperty("worst_lit_db", std::to_string(shown.worst_lit));
  return shown;
}

// Shadows are worth at least a decibel: 2.2 of the helmet, 1.4 of teapots, whose error is otherwise
// that of edges, which lie up to a texel, here a pixel, aside in both. For that error the worst eye
// has 29 dB; two fewer is something else.
void expect_light(const TracerDb& shown) {
  EXPECT_GT(shown.lit, shown.by_rays + 1);
  EXPECT_GT(shown.worst_lit, 27);
}

TEST(LitImpostor, of_a_helmet_shows_the_ray_tracers_light_between_its_views) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const auto scene =
      load_scene(std::filesystem::path(data) / "models/FlightHelmet/FlightHelmet.gltf");
  ASSERT_TRUE(scene) << scene.error().message();
  const TracerDb shown = shown_by_impostors(scene->scene);
  expect_light(shown);
}

TEST(LitImpostor, of_teapots_shows_the_ray_tracers_light_between_its_views) {
  const auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built);
  const TracerDb shown = shown_by_impostors(built->scene);
  expect_light(shown);
}

}  // namespace
}  // namespace rilievo

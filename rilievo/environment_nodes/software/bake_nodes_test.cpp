// Nodes of a scene, baked and drawn without OpenGL.
#include "rilievo/environment_nodes/bake_nodes.h"

#include <gtest/gtest.h>

#include <numeric>

#include "rilievo/capture/raster_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shaders/lit_source.h"
#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/environment_nodes/bake_nodes_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

TEST(BakedNodes, show_the_scene_and_its_sky_without_OpenGL) {
  const auto built = make_builtin("builtin:stonehenge?triangles=20000");
  ASSERT_TRUE(built);
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const PlacedScene placed(built->scene);
  RaySource by_rays(*rays);
  RasterSource raster(placed);
  const EnvironmentNodes nodes = test_baked_nodes::bake(by_rays),
                         others = test_baked_nodes::bake(raster);
  const std::vector<glm::dvec3> places = test_baked_nodes::places(by_rays);
  std::vector<Camera> at_node, between;
  for (int step = 0; step < 5; ++step) {
    at_node.push_back(test_baked_nodes::camera_at(places[0], step));
    between.push_back(
        test_baked_nodes::camera_at(glm::mix(places[0], places[1], 0.2 * step), step));
  }
  test_baked_nodes::expect_alike(nodes, others, built->scene, between);
  // At a node's place it shows what rays see there, blurred: a texel is 2.5 pixels wide.
  const std::vector<Rgba8Image> drawn = test_baked_nodes::draw(nodes, built->scene, at_node);
  for (std::size_t i = 0; i < at_node.size(); ++i) {
    const Result<CapturedPicture> truth = by_rays.capture({.camera = at_node[i], .with_sky = true});
    ASSERT_TRUE(truth);
    EXPECT_GT(psnr_db(srgb8_from_linear(truth->picture.color), drawn[i]), 24) << i;
  }
}

// How near a walk by the ray tracer is to what the tracer sees, from eyes between its nodes; and
// how much nearer than a walk by rays. dB, of each eye. Both are drawn with the same few texels.
struct LitWalk {
  std::vector<double> psnr, gained;
};

LitWalk compare_with_tracer(const Scene& scene, RaySource& by_rays, RayTracer& tracer) {
  LitSource traced(by_rays, tracer, {.samples = 4}), truth_source(by_rays, tracer, {.samples = 16});
  const EnvironmentNodes plain = test_baked_nodes::bake(by_rays),
                         lit = test_baked_nodes::bake(traced);
  const std::vector<glm::dvec3> places = test_baked_nodes::places(by_rays);
  std::vector<Camera> between;
  for (int step = 0; step < 5; ++step)
    between.push_back(
        test_baked_nodes::camera_at(glm::mix(places[0], places[1], 0.1 + 0.2 * step), step));
  const std::vector<Rgba8Image> without = test_baked_nodes::draw(plain, scene, between),
                                with = test_baked_nodes::draw(lit, scene, between);
  LitWalk walk;
  for (std::size_t i = 0; i < between.size(); ++i) {
    const Result<CapturedPicture> truth =
        truth_source.capture({.camera = between[i], .with_sky = true});
    EXPECT_TRUE(truth);
    if (!truth) return walk;
    const Rgba8Image frame = srgb8_from_linear(truth->picture.color);
    walk.psnr.push_back(psnr_db(frame, with[i]));
    walk.gained.push_back(walk.psnr.back() - psnr_db(frame, without[i]));
  }
  return walk;
}

double mean_of(const std::vector<double>& all) {
  return std::accumulate(all.begin(), all.end(), 0.0) / double(all.size());
}

// It has the shadows.
TEST(BakedNodes, of_the_ray_tracer_have_its_shadows_from_eyes_between_them) {
  const auto built = make_builtin("builtin:stonehenge?triangles=20000");
  ASSERT_TRUE(built);
  const auto rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  RaySource by_rays(*rays);
  RayTracer tracer(*rays);
  const LitWalk walk = compare_with_tracer(built->scene, by_rays, tracer);
  ASSERT_EQ(walk.psnr.size(), 5u);
  for (std::size_t i = 0; i < walk.psnr.size(); ++i)
    EXPECT_GT(walk.psnr[i], 20) << i;  // a texel is 2.5 pixels wide
  // Half a decibel in the mean: blur is the larger part of what is wrong.
  EXPECT_GT(mean_of(walk.gained), 0.3);
}

// Teapots of glass that bends light, on a floor: what is behind them is seen through them, which no
// polygons without the tracer show.
TEST(BakedNodes, show_teapots_of_glass_as_the_ray_tracer_does_between_them) {
  const auto built = make_builtin("builtin:teapots?triangles=10000");
  ASSERT_TRUE(built);
  Scene scene = built->scene;
  int of_glass = 0;
  for (Material& material : scene.materials) {
    // The floor, and every other teapot, stay as they are.
    if (++of_glass % 2 != 0) continue;
    material.alpha_mode = AlphaMode::blend;
    material.transmission = 1, material.ior = 1.4f, material.refracts = true;
    material.roughness = 0, material.base_color = glm::vec4(0.95f, 0.98f, 1.0f, 1.0f);
  }
  finish(scene);
  const auto opaque = RayScene::create(scene), all = RayScene::create(scene, 0, RayParts::all);
  ASSERT_TRUE(opaque && all);
  RaySource by_rays(*opaque);
  RayTracer tracer(*all);
  const LitWalk walk = compare_with_tracer(scene, by_rays, tracer);
  ASSERT_EQ(walk.psnr.size(), 5u);
  const double lit_db = mean_of(walk.psnr), gained = mean_of(walk.gained);
  testing::Test::RecordProperty("lit_db", std::to_string(lit_db));
  testing::Test::RecordProperty("gained_db", std::to_string(gained));
  EXPECT_GT(lit_db, 20);
  EXPECT_GT(gained, 0.3);
}

}  // namespace
}  // namespace rilievo

// Nodes of a scene, baked and drawn without OpenGL.
#include "rilievo/environment_nodes/bake_nodes.h"

#include <gtest/gtest.h>

#include "rilievo/capture/raster_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/environment_nodes/bake_nodes_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/scene/builtin/builtin.h"

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

}  // namespace
}  // namespace rilievo

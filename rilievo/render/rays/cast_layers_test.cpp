#include "rilievo/render/rays/cast_layers.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// A floor of two triangles at height y, single- or double-sided, its front up.
void add_floor(Scene& scene, float y, bool double_sided, const glm::vec4& color) {
  Material material;
  material.base_color = color;
  material.double_sided = double_sided;
  material.unlit = true;
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = {{-1, y, -1}, {1, y, -1}, {1, y, 1}, {-1, y, 1}};
  mesh.indices = {0, 2, 1, 0, 3, 2};
  mesh.material = int(scene.materials.size()) - 1;
  scene.meshes.push_back(mesh);
  Model model;
  model.parts.push_back({int(scene.meshes.size()) - 1, glm::mat4(1)});
  scene.models.push_back(model);
  Object object;
  object.model = int(scene.models.size()) - 1;
  scene.objects.push_back(object);
}

Camera from_above(int size) {
  Camera camera = look_at({0, 5, 0}, {0, 0, 0}, {0, 0, -1}, 1.0, size, size, 1, 10);
  camera.projection = Projection::parallel;
  camera.window = {-2, 2, -2, 2};
  return camera;
}

TEST(CastLayers, every_surface_along_a_ray_is_a_sample_backs_of_fronts_too) {
  Scene scene;
  add_floor(scene, 1.0f, false, {1, 0, 0, 1});
  add_floor(scene, 0.5f, true, {0, 1, 0, 1});
  add_floor(scene, 0.0f, false, {0, 0, 1, 1});
  finish(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  const LayeredDepthImage layers = cast_layers(*rays, from_above(8));
  ASSERT_TRUE(validate(layers));
  // The floors cover the middle 4 x 4 of 8 x 8 texels.
  EXPECT_EQ(layers.samples.size(), 16u * 3);
  const std::size_t middle = 3 * 8 + 4;
  ASSERT_EQ(layers.first[middle + 1] - layers.first[middle], 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const LayerSample& s = layers.samples[layers.first[middle] + i];
    EXPECT_NEAR(s.depth, 4.0 + 0.5 * double(i), 1e-5);  // floats
    EXPECT_EQ(s.object, i + 1);
    EXPECT_EQ(s.color, glm::vec4(i == 0, i == 1, i == 2, 1));
  }
  // From below all are there as well, though two are seen from behind.
  Camera below = from_above(8);
  below.world_from_eye =
      look_at({0, -5, 0}, {0, 0, 0}, {0, 0, -1}, 1.0, 8, 8, 1, 10).world_from_eye;
  EXPECT_EQ(cast_layers(*rays, below).samples.size(), 16u * 3);
  // Merged, the first stays for all within the tolerance of it.
  EXPECT_EQ(cast_layers(*rays, from_above(8), {.merge = 0.6}).samples.size(), 16u * 2);
  EXPECT_EQ(cast_layers(*rays, from_above(8), {.merge = 1.1}).samples.size(), 16u);
  EXPECT_EQ(cast_layers(*rays, from_above(8), {.merge = 0, .max_layers = 2}).samples.size(), 32u);
}

TEST(CastLayers, the_first_layer_of_what_is_closed_is_the_ordinary_picture) {
  const Result<BuiltinScene> built = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  const Box box = world_bounds(built->scene);
  Result<Camera> camera = tight_camera(
      Projection::parallel, glm::dvec3(box.center()) + glm::dvec3(30, 25, 40), {0, 1, 0}, box);
  ASSERT_TRUE(camera);
  camera->width = 96, camera->height = 64;
  const DepthImage picture = cast_picture(*rays, *camera);
  const LayeredDepthImage layers = cast_layers(*rays, *camera);
  ASSERT_TRUE(validate(layers));
  int same = 0, covered = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const std::size_t i = std::size_t(y) * 96 + std::size_t(x);
      if (!picture.covered(x, y)) continue;
      ++covered;
      ASSERT_LT(layers.first[i], layers.first[i + 1]);
      const LayerSample& first = layers.samples[layers.first[i]];
      // What is met before lies open and is seen from behind.
      EXPECT_LE(first.depth, picture.depth(x, y));
      same += first.depth == picture.depth(x, y) && first.color == picture.color(x, y);
    }
  EXPECT_GT(covered, 2000);
  EXPECT_GT(same, covered * 95 / 100);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LayeredDepthImage again = cast_layers(*rays, *camera);
  EXPECT_EQ(again.first, layers.first);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/serve/standing_place.h"

#include <gtest/gtest.h>

#include "rilievo/capture/ray_source.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// Boxes, each by its lowest and its highest corner.
Scene scene_of(const std::vector<Box>& boxes) {
  Scene scene;
  scene.materials.emplace_back();
  for (const Box& box : boxes) {
    Mesh mesh;
    mesh.material = 0;
    for (int corner = 0; corner < 8; ++corner)
      mesh.positions.emplace_back(corner & 1 ? box.max.x : box.min.x,
                                  corner & 2 ? box.max.y : box.min.y,
                                  corner & 4 ? box.max.z : box.min.z);
    mesh.normals.assign(8, {0, 1, 0});
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    scene.meshes.push_back(mesh);
    Model model;
    model.parts = {{int(scene.meshes.size()) - 1, glm::mat4(1)}};
    scene.models.push_back(model);
    Object object;
    object.model = int(scene.models.size()) - 1;
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

std::optional<Camera> place_in(const Scene& scene) {
  const Result<RayScene> rays = RayScene::create(scene);
  EXPECT_TRUE(rays.ok());
  RaySource source(*rays);
  return standing_place(source);
}

// A street of houses: the eye is 1.7 m over the ground, in none of them, and not on a roof.
TEST(StandingPlace, InATownItIsOnTheStreet) {
  std::vector<Box> boxes{{{-50, -1, -50}, {50, 0, 50}}};
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      const glm::vec3 corner(-46.0f + 9.5f * float(i), 0, -46.0f + 9.5f * float(j));
      boxes.push_back({corner, corner + glm::vec3(6, 5, 6)});
    }
  const std::optional<Camera> place = place_in(scene_of(boxes));
  ASSERT_TRUE(place);
  const glm::dvec3 eye = place->position();
  EXPECT_NEAR(eye.y, 1.7, 1e-3);
  EXPECT_LT(glm::length(glm::dvec2(eye.x, eye.z)), 40);
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    const bool within = boxes[i].min.x - 0.5 < eye.x && eye.x < boxes[i].max.x + 0.5 &&
                        boxes[i].min.z - 0.5 < eye.z && eye.z < boxes[i].max.z + 0.5;
    EXPECT_FALSE(within) << i;
  }
  EXPECT_NEAR(place->forward().y, 0, 1e-9);
}

// A hall with a roof: within, on its floor.
TEST(StandingPlace, InAHallItIsUnderTheRoof) {
  const std::vector<Box> boxes{{{-10, -1, -10}, {10, 0, 10}},       {{-10, 4, -10}, {10, 4.5f, 10}},
                               {{-10, 0, -10}, {-9.8f, 4, 10}},     {{9.8f, 0, -10}, {10, 4, 10}},
                               {{-10, 0, -10}, {10, 4, -9.8f}},     {{-10, 0, 9.8f}, {10, 4, 10}},
                               {{-0.5f, 0, -0.5f}, {0.5f, 4, 0.5f}}};
  const std::optional<Camera> place = place_in(scene_of(boxes));
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->position().y, 1.7, 1e-3);
  EXPECT_LT(std::abs(place->position().x), 9.5);
  EXPECT_LT(std::abs(place->position().z), 9.5);
}

TEST(StandingPlace, OfAnObjectThereIsNone) {
  EXPECT_FALSE(place_in(make_builtin("builtin:teapot?triangles=2000")->scene));
  EXPECT_FALSE(place_in(scene_of({{{0, 0, 0}, {3, 3, 3}}})));
}

}  // namespace
}  // namespace rilievo

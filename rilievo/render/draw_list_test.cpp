#include "rilievo/render/draw_list.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <random>

namespace rilievo {
namespace {

TEST(Frustum, never_culls_a_box_with_a_point_in_view) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> u(-1, 1);
  int culled = 0, seen = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 eye(1e4 * u(rng), u(rng), u(rng));
    Camera camera =
        look_at(eye, eye + glm::dvec3(u(rng), u(rng), u(rng)), {0, 1, 0}, 0.8, 16, 9, 0.5, 30);
    if (i % 2) camera.projection = Projection::parallel;
    Box box;
    const glm::vec3 center = glm::vec3(eye) + 20.0f * glm::vec3(u(rng), u(rng), u(rng));
    box.add(center), box.add(center + glm::vec3(u(rng), u(rng), u(rng)) * 3.0f);
    // Brute force: points of the box, tested one by one.
    bool any_inside = false;
    for (int k = 0; k < 30; ++k) {
      const glm::vec3 t(0.5f + 0.5f * u(rng), 0.5f + 0.5f * u(rng), 0.5f + 0.5f * u(rng));
      const glm::dvec4 clip =
          clip_from_world(camera) * glm::dvec4(glm::mix(box.min, box.max, t), 1);
      any_inside |=
          glm::abs(clip.x) <= clip.w && glm::abs(clip.y) <= clip.w && glm::abs(clip.z) <= clip.w;
    }
    const bool touches = may_touch(frustum_of(camera), box);
    EXPECT_TRUE(touches || !any_inside);
    culled += !touches;
    seen += any_inside;
  }
  EXPECT_GT(culled, 5000);  // and it does cull
  EXPECT_GT(seen, 500);
}

Scene random_scene(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  scene.meshes.resize(4);
  for (int m = 0; m < 3; ++m) {
    Model model;
    for (int p = 0; p <= m; ++p) {
      Part part;
      part.mesh = (m + p) % 4;
      if (p == 1) part.model_from_mesh = glm::scale(glm::mat4(1), glm::vec3(-1, 1, 1));
      model.parts.push_back(part);
    }
    scene.models.push_back(model);
  }
  for (int i = 0; i < 200; ++i) {
    Object object;
    object.model = i % 3;
    object.placement = glm::translate(glm::mat4(1), 50.0f * glm::vec3(u(rng), u(rng), u(rng)));
    if (i % 5 == 0) object.placement = object.placement * glm::scale(glm::mat4(1), {1, -1, 1});
    scene.objects.push_back(object);
  }
  return scene;
}

TEST(DrawList, holds_every_instance_once_front_to_back_and_mirrored_ones_apart) {
  std::mt19937 rng(2);
  const Scene scene = random_scene(rng);
  std::vector<glm::mat4> poses;
  std::vector<Box> bounds;
  std::vector<std::uint32_t> objects;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    poses.push_back(scene.objects[i].placement);
    Box box;
    box.add(glm::vec3(poses[i][3]));
    bounds.push_back(box);
    if (i % 3) objects.push_back(i);
  }
  const Camera camera = look_at({7, 8, 9}, {0, 0, 0}, {0, 1, 0}, 1, 16, 9, 1, 100);
  const bool included[] = {true, true, false, true};
  DrawList list;
  list.build_front_to_back(scene, camera, objects, poses, bounds, included);

  std::map<std::pair<std::uint32_t, std::uint32_t>, int> drawn, expected;  // mesh, object
  for (std::uint32_t i : objects)
    for (const Part& part : scene.models[std::size_t(scene.objects[i].model)].parts)
      if (included[part.mesh]) ++expected[{std::uint32_t(part.mesh), i}];
  float nearest_of_last_batch = 0;
  for (const Batch& batch : list.batches()) {
    float last = 0;
    for (std::uint32_t k = 0; k < batch.count; ++k) {
      const Placement& placement = list.instances()[batch.first + k];
      ++drawn[{batch.mesh, placement.object}];
      EXPECT_EQ(glm::determinant(glm::mat3(placement.relative_from_mesh)) < 0, batch.mirrored);
      const float distance = glm::length(glm::vec3(placement.relative_from_mesh[3]));
      EXPECT_GE(distance, last * (1 - 1e-5f));  // rounding of floats
      if (k == 0) {
        EXPECT_GE(distance, nearest_of_last_batch * (1 - 1e-5f));
        nearest_of_last_batch = distance;
      }
      last = distance;
    }
  }
  EXPECT_EQ(drawn, expected);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/scene/shading_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/levels.h"

namespace rilievo {
namespace {

// A right triangle of area 2 whose normals all look so far aside.
Mesh tilted(double angle) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  mesh.normals.assign(3, {float(std::sin(angle)), 0, float(std::cos(angle))});
  mesh.indices = {0, 1, 2};
  return mesh;
}

TEST(ShadingError, is_the_angle_times_the_size) {
  for (const double angle : {0.0, 0.1, 0.5})
    EXPECT_NEAR(shading_error(tilted(angle), tilted(angle).indices), angle * std::sqrt(2), 1e-3);
  // As much if it winds the other way.
  Mesh other = tilted(0.1);
  std::swap(other.indices[0], other.indices[1]);
  EXPECT_NEAR(shading_error(other, other.indices), 0.1 * std::sqrt(2), 1e-3);
  other.normals.clear();
  EXPECT_EQ(shading_error(other, other.indices), 0);
}

TEST(ShadingError, counts_by_area) {
  Mesh mesh = tilted(0.2);
  for (const glm::vec3& p : {glm::vec3{5, 0, 0}, {7, 0, 0}, {5, 2, 0}})
    mesh.positions.push_back(p), mesh.normals.emplace_back(0, 0, 1);
  for (const std::uint32_t index : {3u, 4u, 5u}) mesh.indices.push_back(index);
  // Half of the area is right.
  EXPECT_NEAR(shading_error(mesh, mesh.indices), 0.2, 1e-3);
}

// A block with round edges: its faces lose their inner vertices at no distance.
TEST(ShadingError, a_flat_face_between_round_edges_does_not_become_coarse_at_no_error) {
  Mesh mesh;
  const glm::vec3 half(1);
  BoxShape shape;
  shape.n = glm::ivec3(20);
  add_box(mesh, shape,
          [&](const glm::vec3& c) { return BuiltVertex{rounded_box(c, half, 0.1f, shape.n)}; });
  Scene scene;
  scene.meshes = {mesh};
  scene.models.resize(1);
  scene.models[0].parts = {{0, glm::mat4(1)}};
  scene.objects.resize(1);
  finish(scene);
  EXPECT_LT(shading_error(scene.meshes[0], scene.meshes[0].indices), 0.01);
  const LeveledScene leveled = make_levels(scene);
  const std::vector<ModelLevel>& levels = leveled.levels[0];
  ASSERT_GE(levels.size(), 4u);
  for (std::size_t i = 1; i < levels.size(); ++i) {
    const Model& model = leveled.scene.models[std::size_t(levels[i].model)];
    const Mesh& level = leveled.scene.meshes[std::size_t(model.parts[0].mesh)];
    EXPECT_GE(levels[i].error, 0.99 * shading_error(level, level.indices) - 0.01);
  }
  // 500 triangles of 4800.
  EXPECT_GT(levels[3].error, 0.05);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/scene/levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rilievo {
namespace {

// A unit sphere of many triangles, twice, and a square.
Scene sphere_scene() {
  constexpr int kRings = 40;
  Mesh sphere, square;
  for (int i = 0; i <= kRings; ++i)
    for (int k = 0; k <= 2 * kRings; ++k) {
      const double up = 3.14159265358979 * i / kRings, round = 3.14159265358979 * k / kRings;
      const glm::vec3 p(std::sin(up) * std::cos(round), std::cos(up),
                        std::sin(up) * std::sin(round));
      sphere.positions.push_back(p);
      sphere.normals.push_back(p);
      sphere.uv[0].emplace_back(float(k), float(i));
      if (i == kRings || k == 2 * kRings) continue;
      const std::uint32_t a = std::uint32_t(i * (2 * kRings + 1) + k), b = a + 2 * kRings + 1;
      for (const std::uint32_t index : {a, b, a + 1, a + 1, b, b + 1})
        sphere.indices.push_back(index);
    }
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.normals.assign(4, {0, 0, 1});
  square.indices = {0, 1, 2, 0, 2, 3};
  Scene scene;
  scene.meshes = {sphere, square};
  scene.models.resize(1);
  scene.models[0].parts = {{0, glm::mat4(1)}, {1, glm::mat4(1)}};
  scene.objects.resize(2);
  finish(scene);
  return scene;
}

TEST(MakeLevels, each_level_is_coarser_and_says_a_larger_error) {
  const Scene scene = sphere_scene();
  const LeveledScene leveled = make_levels(scene);
  ASSERT_TRUE(validate(leveled.scene).ok());
  ASSERT_EQ(leveled.levels.size(), 1u);
  const std::vector<ModelLevel>& levels = leveled.levels[0];
  ASSERT_GE(levels.size(), 5u);
  EXPECT_EQ(levels[0].model, 0);
  for (std::size_t i = 1; i < levels.size(); ++i) {
    EXPECT_LT(leveled.scene.models[std::size_t(levels[i].model)].triangles,
              leveled.scene.models[std::size_t(levels[i - 1].model)].triangles * 2 / 3);
    EXPECT_GT(levels[i].error, levels[i - 1].error);
  }
  // What objects show has not changed.
  for (const Object& object : leveled.scene.objects) EXPECT_EQ(object.model, 0);
  EXPECT_EQ(leveled.scene.meshes[0].indices, scene.meshes[0].indices);
}

// The mean of a level's vertices cannot leave the sphere: they are vertices of the mesh. Its
// triangles sag; a triangle's middle lies as deep as its sag.
TEST(MakeLevels, a_spheres_levels_sag_by_about_the_error_that_they_say) {
  const LeveledScene leveled = make_levels(sphere_scene());
  for (std::size_t i = 1; i < leveled.levels[0].size(); ++i) {
    const ModelLevel& level = leveled.levels[0][i];
    const Part& part = leveled.scene.models[std::size_t(level.model)].parts[0];
    const Mesh& mesh = leveled.scene.meshes[std::size_t(part.mesh)];
    double sag = 0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
      glm::vec3 middle(0);
      for (std::size_t k = 0; k < 3; ++k) middle += mesh.positions[mesh.indices[t + k]] / 3.0f;
      sag = std::max(sag, 1.0 - double(glm::length(middle)));
    }
    // Quadrics say a mean over planes, not the largest distance: within a factor of four.
    if (mesh.indices.size() > 3 * 100) {
      EXPECT_LT(sag, 4 * level.error + 0.01) << i;
    }
    EXPECT_EQ(mesh.uv[0].size(), mesh.positions.size());
  }
}

TEST(ChooseLevel, takes_the_coarsest_that_is_allowed) {
  const std::vector<ModelLevel> levels{{0, 0}, {3, 0.1}, {4, 0.4}};
  EXPECT_EQ(choose_level(levels, 0).model, 0);
  EXPECT_EQ(choose_level(levels, 0.1).model, 3);
  EXPECT_EQ(choose_level(levels, 0.39).model, 3);
  EXPECT_EQ(choose_level(levels, std::numeric_limits<double>::infinity()).model, 4);
}

}  // namespace
}  // namespace rilievo

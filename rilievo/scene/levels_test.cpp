#include "rilievo/scene/levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/random.h"
#include "rilievo/scene/mesh_distance.h"

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
TEST(MakeLevels, the_finest_level_has_as_few_triangles_as_asked_for) {
  const Scene scene = sphere_scene();  // of 6400
  LevelsOptions options;
  options.most_triangles = 500;
  const LeveledScene few = make_levels(scene, options), all = make_levels(scene);
  const auto triangles = [](const LeveledScene& of, std::size_t level) {
    return of.scene.models[std::size_t(of.levels[0][level].model)].triangles;
  };
  EXPECT_LE(triangles(few, 1), 502u);
  EXPECT_GT(triangles(few, 1), 350u);
  EXPECT_LT(triangles(few, 2), 300u);
  // At once it is no less exact than a half again and again, whose errors add up.
  std::size_t same = 1;
  while (triangles(all, same) > 502) ++same;
  EXPECT_LT(few.levels[0][1].error, 1.2 * all.levels[0][same].error);
  // Meshes that have fewer are halved as ever.
  options.most_triangles = 5000;
  EXPECT_EQ(triangles(make_levels(scene, options), 1), triangles(all, 1));
}

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

// Points of one model's surface, from the nearest of another's, with their parts placed.
double sampled_distance(const Scene& scene, const Model& from, const Model& to, Random& random) {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  const auto at = [&](const Part& part, std::uint32_t vertex) {
    const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
    return glm::vec3(part.model_from_mesh * glm::vec4(mesh.positions[vertex], 1));
  };
  for (const Part& part : to.parts)
    for (const std::uint32_t vertex : scene.meshes[std::size_t(part.mesh)].indices) {
      indices.push_back(std::uint32_t(positions.size()));
      positions.push_back(at(part, vertex));
    }
  const TriangleTree tree(positions, indices);
  double largest = 0;
  for (const Part& part : from.parts) {
    const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      float u = random.unit(), v = random.unit();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const glm::vec3 p = (1 - u - v) * at(part, mesh.indices[t]) +
                          u * at(part, mesh.indices[t + 1]) + v * at(part, mesh.indices[t + 2]);
      largest = std::max(largest, std::sqrt(tree.nearest(glm::dvec3(p)).square));
    }
  }
  return largest;
}

TEST(MakeBoundedLevels, no_sampled_point_is_farther_away_than_the_error) {
  Scene scene = sphere_scene();
  // Scaled, and sheared: an error grows by more than the longest axis.
  scene.models[0].parts[0].model_from_mesh =
      glm::mat4(glm::vec4(2, 0, 0, 0), glm::vec4(1.8f, 1, 0, 0), glm::vec4(0, 0, 1, 0),
                glm::vec4(5, 1, 0, 1));
  scene.models[0].parts.push_back({0, glm::mat4(1)});
  finish(scene);
  const LeveledScene leveled = make_bounded_levels(scene);
  ASSERT_TRUE(validate(leveled.scene).ok());
  const auto model = [&](const ModelLevel& level) -> const Model& {
    return leveled.scene.models[std::size_t(level.model)];
  };
  const std::vector<ModelLevel>& levels = leveled.levels[0];
  ASSERT_GE(levels.size(), 4u);
  Random random(6);
  for (std::size_t i = 1; i < levels.size(); ++i) {
    EXPECT_GT(levels[i].error, levels[i - 1].error);
    EXPECT_LT(model(levels[i]).triangles, model(levels[i - 1]).triangles);
    EXPECT_EQ(model(levels[i]).bounds.min, model(levels[0]).bounds.min);
    EXPECT_EQ(model(levels[i]).bounds.max, model(levels[0]).bounds.max);
    const double there =
                     sampled_distance(leveled.scene, model(levels[0]), model(levels[i]), random),
                 back = sampled_distance(leveled.scene, model(levels[i]), model(levels[0]), random);
    // Single precision of coordinates up to 8.
    EXPECT_LE(std::max(there, back), levels[i].error + 1e-6) << i;
    // It is no mere guess: errors that do not lie along the part's longest axis, three times as
    // long as the others, are a third of the bound, and samples seldom meet the largest.
    EXPECT_GE(std::max(there, back), 0.25 * levels[i].error) << i;
  }
}

TEST(MakeBoundedLevels, leaves_what_is_masked_or_blends_as_it_is) {
  for (const AlphaMode mode : {AlphaMode::mask, AlphaMode::blend}) {
    Scene scene = sphere_scene();
    scene.materials.emplace_back();
    scene.materials[0].alpha_mode = mode;
    scene.meshes[0].material = 0;
    EXPECT_EQ(make_bounded_levels(scene).levels[0].size(), 1u);
  }
}

TEST(LargestStretch, is_no_less_than_what_a_transform_does_to_any_direction) {
  Random random(8);
  for (int round = 0; round < 200; ++round) {
    glm::mat4 m(1);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) m[i][k] = random.between(-2, 2);
    for (int i = 0; i < 20; ++i) {
      const glm::vec3 v(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      EXPECT_LE(double(glm::length(glm::mat3(m) * v)),
                largest_stretch(m) * double(glm::length(v)) * (1 + 1e-6));  // single precision
    }
  }
  EXPECT_NEAR(largest_stretch(glm::mat4(3.0f)), 3, 1e-12);
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

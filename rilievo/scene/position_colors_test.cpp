#include "rilievo/scene/position_colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

// The definition in the header.
glm::dvec3 code_of(const glm::dvec3& position, double half_period) {
  glm::dvec3 out;
  const glm::dvec3 t = code_directions() * position / half_period;
  for (int k = 0; k < 3; ++k) out[k] = 1 - std::abs(t[k] - 2 * std::floor(0.5 * t[k]) - 1);
  return out;
}

TEST(PositionColors, a_color_tells_the_place_near_a_guess) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 5000; ++i) {
    const double half_period = 0.1 + std::abs(u(rng));
    const glm::dvec3 place(30 * u(rng), 30 * u(rng), 30 * u(rng));
    const glm::dvec3 code = code_of(place, half_period);
    const glm::u8vec4 color(glm::round(255.0 * code), 255);
    // Each direction up to a half of the half period off, so that no other period is nearer.
    const glm::dvec3 guess = place + transpose(code_directions()) *
                                         (0.49 * half_period * glm::dvec3(u(rng), u(rng), u(rng)));
    double nearest = 1e9;
    for (int c = 0; c < kCodeCandidates; ++c) {
      const glm::dvec3 decoded = decode_position(color, guess, half_period, c);
      nearest = std::min(nearest, glm::distance(decoded, place));
      // Whichever it is, it has this colour.
      EXPECT_LT(glm::distance(code_of(decoded, half_period), glm::dvec3(color) / 255.0), 1e-6);
    }
    // Half a byte in each of three directions.
    EXPECT_LE(nearest, 1.0001 * half_period * std::sqrt(3.0) / 510);
  }
}

TEST(PositionColors, no_direction_is_along_an_axis) {
  const glm::dmat3& d = code_directions();
  for (int axis = 0; axis < 3; ++axis) {
    // What is left of the waves in a plane across the axis.
    for (int wave = 0; wave < 3; ++wave) EXPECT_LT(std::abs(d[axis][wave]), 0.95);
  }
  EXPECT_NEAR(glm::determinant(d), 1, 1e-12);
}

Scene scene_of_parts() {
  Scene scene;
  scene.images.emplace_back(1, 1, glm::u8vec4(255));
  scene.textures.emplace_back();
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend}) {
    Material material;
    material.alpha_mode = mode;
    material.base_color_texture.texture = 0;
    material.base_color.a = 0.75f;
    material.double_sided = mode == AlphaMode::mask;
    scene.materials.push_back(material);
    Mesh mesh;
    mesh.material = int(scene.materials.size()) - 1;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    scene.meshes.push_back(mesh);
  }
  Model model;
  for (const int mesh : {0, 1, 2, 0}) model.parts.push_back({mesh, glm::mat4(1)});
  model.parts[3].model_from_mesh[3] = glm::vec4(5, 6, 7, 1);
  scene.models = {model, model};
  scene.objects.resize(2);
  scene.objects[1].model = 1;
  finish(scene);
  return scene;
}

TEST(PositionColors, a_part_has_the_code_of_its_place_in_the_model) {
  const Scene scene = scene_of_parts();
  const double half_periods[] = {0.5, 2};
  const Scene coded = with_position_colors(scene, half_periods);
  ASSERT_TRUE(validate(coded).ok());
  ASSERT_EQ(coded.meshes.size(), 8u);
  for (std::size_t m = 0; m < 2; ++m)
    for (const Part& part : coded.models[m].parts) {
      const Mesh& mesh = coded.meshes[std::size_t(part.mesh)];
      const Material& material = coded.materials[std::size_t(mesh.material)];
      ASSERT_TRUE(material.code_from_mesh);
      for (const glm::vec3& p : mesh.positions) {
        const glm::dvec3 in_model(part.model_from_mesh * glm::vec4(p, 1));
        const glm::dvec3 wanted = code_directions() * in_model / half_periods[m];
        EXPECT_LT(glm::distance(glm::dvec3(*material.code_from_mesh * glm::vec4(p, 1)), wanted),
                  1e-5);  // floats
      }
    }
  EXPECT_EQ(count_triangles(coded), count_triangles(scene));
}

TEST(PositionColors, masks_and_sides_stay_and_what_blends_shows_nothing) {
  const Scene scene = scene_of_parts();
  const double half_periods[] = {1, 1};
  const Scene coded = with_position_colors(scene, half_periods);
  const auto material_of = [&](int part) -> const Material& {
    return coded.materials[std::size_t(
        coded.meshes[std::size_t(coded.models[0].parts[std::size_t(part)].mesh)].material)];
  };
  EXPECT_EQ(material_of(0).base_color_texture.texture, -1);
  EXPECT_EQ(material_of(1).alpha_mode, AlphaMode::mask);
  EXPECT_EQ(material_of(1).base_color_texture.texture, 0);
  EXPECT_EQ(material_of(1).base_color.a, 0.75f);
  EXPECT_TRUE(material_of(1).double_sided);
  EXPECT_EQ(material_of(2).alpha_mode, AlphaMode::blend);
  EXPECT_EQ(material_of(2).base_color.a, 0);
}

}  // namespace
}  // namespace rilievo

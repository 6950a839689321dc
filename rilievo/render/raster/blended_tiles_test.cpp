#include "rilievo/render/raster/blended_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "rilievo/core/random.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

// Colours of corners are affine in a triangle that faces the eye: so is what lies over nothing.
TEST(BlendedTiles, let_through_what_their_corners_say) {
  constexpr int kSize = 64;
  const glm::vec3 alphas(0.1f, 0.5f, 0.9f);
  Scene scene;
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}};
  mesh.indices = {0, 1, 2};
  for (int k = 0; k < 3; ++k) mesh.colors.emplace_back(1, 1, 1, alphas[k]);
  mesh.material = 0;
  Material& material = scene.materials.emplace_back();
  material.unlit = true, material.alpha_mode = AlphaMode::blend;
  scene.meshes.push_back(mesh);
  scene.models.emplace_back().parts.push_back({0, glm::mat4(1)});
  scene.objects.emplace_back();
  finish(scene);
  const PlacedScene placed(scene);
  const Camera camera = look_at({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.6, kSize, kSize, 1, 9);
  BlendedTiles tiles(scene);
  const std::uint32_t object = 0;
  tiles.place(camera, 1, placed, {&object, 1});
  ASSERT_TRUE(tiles.any());
  SoftwareTarget target(kSize, kSize, 1);
  const TileDrawer* drawers[] = {&tiles};
  target.draw(camera.z_far, drawers);
  int shown = 0;
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const glm::dvec3 at = world_from_raster(camera, {x + 0.5, y + 0.5}, 4.0);
      const double b = (at.x + 1) / 2, c = (at.y + 1) / 2, a = 1 - b - c;
      if (std::min({a, b, c}) < 0.02) continue;
      ++shown;
      const double alpha = a * double(alphas[0]) + b * double(alphas[1]) + c * double(alphas[2]);
      ASSERT_NEAR(target.color()(x, y).a, 255 * alpha, 1) << x << " " << y;
      ASSERT_NEAR(target.color()(x, y).g, 255 * alpha, 1) << x << " " << y;
    }
  EXPECT_GT(shown, 500);
}

// Against the lines of its edges, pixel by pixel.
TEST(BlendedTiles, show_what_of_a_triangle_is_in_the_frame_however_far_its_corners_are) {
  constexpr int kSize = 48;
  constexpr double kFar = 6;  // what lies farther away is hidden
  Random random(5);
  const auto between = [&](float low, float high) { return double(random.between(low, high)); };
  int shown = 0, beside = 0, behind = 0;
  for (int run = 0; run < 60; ++run) {
    const Camera camera =
        run % 3 ? look_at({1, 2, 3}, {4, -1, 5}, {0.1, 1, 0.2}, 0.2, kSize, kSize, 0.1, kFar)
                : look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.2, kSize, kSize, 0.1, kFar);
    // Around a place in the frame, or with an edge through it.
    const glm::dvec2 place{between(0, kSize), between(0, kSize)};
    const double turn = between(0, 6),
                 opposite = run % 2 ? glm::pi<double>() : 2.1 + between(-0.9f, 0.9f);
    Scene scene;
    Mesh& mesh = scene.meshes.emplace_back();
    glm::dvec3 corner[3];  // x w, y w and w, in pixels
    for (const double angle : {turn, turn + opposite, turn - 2.1 + between(-0.9f, 0.9f)}) {
      const double away = std::pow(10, random.below(2) ? between(6, 6.7f) : between(0.5f, 6));
      const glm::dvec2 at = place + away * glm::dvec2(std::cos(angle), std::sin(angle));
      mesh.positions.emplace_back(world_from_raster(camera, at, between(0.3f, 20)));
      const glm::dvec3 seen = raster_from_world(camera, glm::dvec3(mesh.positions.back()));
      corner[mesh.positions.size() - 1] = {seen.x * seen.z, seen.y * seen.z, seen.z};
    }
    mesh.indices = {0, 1, 2};
    mesh.material = 0;
    Material& material = scene.materials.emplace_back();
    material.unlit = material.double_sided = true, material.alpha_mode = AlphaMode::blend;
    material.base_color.a = 0.4f;
    scene.models.emplace_back().parts.push_back({0, glm::mat4(1)});
    scene.objects.emplace_back();
    finish(scene);
    const PlacedScene placed(scene);
    BlendedTiles tiles(scene);
    const std::uint32_t object = 0;
    const int samples = run % 4 < 2 ? 1 : 4;
    tiles.place(camera, samples, placed, {&object, 1});
    SoftwareTarget target(kSize, kSize, samples);
    const TileDrawer* drawers[] = {&tiles};
    target.draw(kFar, drawers);
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        // Each edge's share of 1 / w, and how far inside of it the pixel is.
        double per_w = 0, inside = 1e300;
        for (int k = 0; k < 3; ++k) {
          const glm::dvec3 line = glm::cross(corner[(k + 1) % 3], corner[(k + 2) % 3]);
          const double share =
              glm::dot(line, glm::dvec3(x + 0.5, y + 0.5, 1)) / glm::dot(line, corner[k]);
          per_w += share;
          inside = std::min(
              inside, share * std::abs(glm::dot(line, corner[k])) / std::hypot(line.x, line.y));
        }
        // Floats place a corner to 3e-7 of its way, across it, and w to 1 % there.
        if (std::abs(inside) < 2 || std::abs(per_w * kFar - 1) < 0.05) continue;
        const bool covered = inside > 0 && per_w > 1 / kFar;
        ASSERT_NEAR(target.color()(x, y).a, covered ? 102 : 0, 1) << run << " " << x << " " << y;
        ++(covered ? shown : inside < 0 ? beside : behind);
      }
  }
  EXPECT_GT(shown, 10'000);
  EXPECT_GT(beside, 10'000);
  EXPECT_GT(behind, 10'000);
}

}  // namespace
}  // namespace rilievo

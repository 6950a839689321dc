#include "rilievo/render/raster/blended_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace rilievo

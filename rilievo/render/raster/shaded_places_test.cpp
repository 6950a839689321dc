// Which place does the colour of a texel with several samples tell?
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {
namespace {

// A box whose colours are its places, linearly.
constexpr float kScale = 0.3f, kMiddle = 0.5f;

Scene colored_box(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(0.05f, 0.8f);
  const glm::vec3 half(u(rng), u(rng), u(rng));
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.push_back(half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    mesh.colors.emplace_back(kMiddle + kScale * mesh.positions.back(), 1);
  }
  mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  mesh.material = 0;
  Scene scene;
  scene.materials.emplace_back().unlit = true;
  scene.meshes.push_back(mesh);
  scene.models.emplace_back().parts.push_back({0, glm::mat4(1)});
  scene.objects.emplace_back();
  finish(scene);
  return scene;
}

// Of slanted faces, of which a texel may show one sample only, too: shaded at the texel's centre,
// where the face's plane is far away, or at the corner or edge with the nearest weights, the colour
// is that of a place several texels away.
TEST(ShadedPlaces, a_texel_tells_a_place_in_it) {
  std::mt19937 rng(7);
  std::normal_distribution<double> n;
  int texels = 0, partial = 0;
  double farthest = 0;
  for (int i = 0; i < 300; ++i) {
    const Scene scene = colored_box(rng);
    const glm::dvec3 eye = 4.0 * glm::normalize(glm::dvec3(n(rng), n(rng), n(rng)));
    const Camera camera = look_at(eye, {0, 0, 0}, {0.1, 1, 0.2}, 0.5, 24, 24, 0.5, 10);
    PictureRasterizer rasterizer(scene);
    const std::uint32_t all[] = {0};
    const glm::mat4 pose(1);
    const DepthImage picture = rasterizer.capture(camera, all, {&pose, 1}, 4);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const glm::vec4 color = picture.color(x, y);
        if (color.a == 0) continue;
        const glm::dvec3 place((glm::vec3(color) / color.a - kMiddle) / kScale);
        const glm::dvec2 from =
            glm::dvec2(raster_from_world(camera, place)) - glm::dvec2(x + 0.5, y + 0.5);
        // Samples lie within 0.375 of the middle; colours are floats.
        farthest = std::max({farthest, std::abs(from.x), std::abs(from.y)});
        ++texels;
        partial += color.a < 1;
      }
  }
  EXPECT_GT(texels, 20'000);
  EXPECT_GT(partial, 2'000);
  EXPECT_LE(farthest, 0.375 + 1e-3);
}

}  // namespace
}  // namespace rilievo

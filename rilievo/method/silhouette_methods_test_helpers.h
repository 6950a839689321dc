// A tilted red plate before a green wall, as the methods draw its silhouette by a backend.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/method/cable_methods_test_helpers.h"

namespace rilievo::test_silhouette {

inline constexpr int kWidth = test_cable::kWidth, kHeight = test_cable::kHeight;

// Object 1 is the plate, 1.2 m a side, a metre before the wall, object 2.
struct TiltedPlate {
  static constexpr float kHalf = 0.6f;
  explicit TiltedPlate(double turn) {
    test_plate::add_red_and_green(scene);
    scene.meshes = {pieces(), test_plate::square(4.0f)};
    scene.meshes[0].material = 0, scene.meshes[1].material = 1;
    placed =
        glm::rotate(glm::rotate(glm::translate(glm::mat4(1), {0, 0, 1}), float(turn), {0, 0, 1}),
                    0.3f, {0, 1, 0});
    scene.models = {{"plate", {{0, placed}}, {}, 0}, {"wall", {{1, glm::mat4(1)}}, {}, 0}};
    scene.objects.resize(2);
    scene.objects[1].model = 1;
    finish(scene);
  }
  // A square in pieces, since light objects are drawn as polygons.
  static Mesh pieces() {
    constexpr int kPieces = 16;
    Mesh mesh;
    for (int i = 0; i <= kPieces; ++i)
      for (int k = 0; k <= kPieces; ++k)
        mesh.positions.emplace_back(kHalf * (2.0f * k / kPieces - 1),
                                    kHalf * (2.0f * i / kPieces - 1), 0);
    for (std::uint32_t i = 0; i < kPieces; ++i)
      for (std::uint32_t k = 0; k < kPieces; ++k) {
        const std::uint32_t a = i * (kPieces + 1) + k, b = a + kPieces + 1;
        for (const std::uint32_t corner : {a, a + 1, b + 1, a, b + 1, b})
          mesh.indices.push_back(corner);
      }
    return mesh;
  }
  // How much of a pixel the plate covers, by 16 x 16 places of it.
  [[nodiscard]] double coverage(const Camera& camera, int x, int y) const {
    std::array<glm::dvec2, 4> corners;
    for (std::size_t c = 0; c < 4; ++c)
      corners[c] = glm::dvec2(
          raster_from_world(camera, glm::dvec3(placed * glm::vec4(c == 1 || c == 2 ? kHalf : -kHalf,
                                                                  c >= 2 ? kHalf : -kHalf, 0, 1))));
    int inside = 0;
    for (int i = 0; i < 256; ++i) {
      const glm::dvec2 at(x + (i % 16 + 0.5) / 16, y + (i / 16 + 0.5) / 16);
      int left = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        const glm::dvec2 along = corners[(c + 1) % 4] - corners[c], to = at - corners[c];
        left += along.x * to.y - along.y * to.x > 0;
      }
      inside += left == 0 || left == 4;
    }
    return inside / 256.0;
  }

  Scene scene;
  glm::mat4 placed{1};
};

// Along the silhouette, in pixels that the plate covers by 0.25 to 0.75.
struct SilhouetteFigures {
  int pixels = 0;
  double between = 0;  // the share of those that are neither red nor green, but between
  double off = 0;      // how far red is from the coverage, in the mean
};

inline SilhouetteFigures silhouettes(const std::string& method,
                                     const test_cable::MakeBackend& make) {
  Box eyes;
  eyes.add(glm::vec3(-0.4f, -0.2f, 2.9f)), eyes.add(glm::vec3(0.5f, 0.3f, 3.1f));
  SilhouetteFigures figures;
  for (const double turn : {0.1, 0.4, 0.9}) {
    const TiltedPlate plate(turn);
    const std::unique_ptr<Backend> backend = make(plate.scene);
    Result<Method> made = make_method(method, test_cable::small_pictures(method, eyes), *backend);
    EXPECT_TRUE(made.ok()) << made.error().message();
    if (!made) return {};
    const auto target = backend->make_target(kWidth, kHeight);
    EXPECT_TRUE(target.ok());
    for (int i = 0; i < 4; ++i) {
      const Camera camera =
          test_cable::camera_at({-0.4 + 0.25 * i, -0.2 + 0.15 * (i % 3), 2.9 + 0.05 * i});
      EXPECT_TRUE((*target)->draw(*made->frames, camera, 0).ok());
      EXPECT_LE(made->frames->stats().polygons, method == "direct" ? 2 : 1);  // the wall
      const Rgba8Image frame = (*target)->color();
      for (int y = 2; y < kHeight - 2; ++y)
        for (int x = 2; x < kWidth - 2; ++x) {
          const double covered = plate.coverage(camera, x, y);
          if (covered < 0.25 || covered > 0.75) continue;
          // Samples are averaged as the frame has them.
          const double red = frame(x, y).r / 255.0;
          ++figures.pixels;
          figures.between += red > 0.05 && red < 0.95;
          figures.off += std::abs(red - covered);
        }
    }
  }
  figures.between /= figures.pixels, figures.off /= figures.pixels;
  testing::Test::RecordProperty("between", std::to_string(figures.between));
  testing::Test::RecordProperty("off", std::to_string(figures.off));
  return figures;
}

// Direct drawing at 4 samples has 1 and 0.09. A silhouette of a picture lies where its texels have
// it, up to half a texel, here a pixel, aside. Pictures whose pixels show one surface in all
// samples have 0 and 0.5.
inline void expect_mixed(const SilhouetteFigures& figures) {
  EXPECT_GT(figures.pixels, 1000);
  EXPECT_GT(figures.between, 0.6);
  EXPECT_LT(figures.off, 0.25);
}

}  // namespace rilievo::test_silhouette

#include "rilievo/capture/picture_camera.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo {
namespace {

TEST(PictureCamera, holds_the_bounds_inside_its_border_at_no_less_than_a_texel_a_pixel) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  int made = 0;
  for (int i = 0; i < 3000; ++i) {
    const Camera frame = look_at({u(rng), u(rng), 10}, {4 * u(rng), 3 * u(rng), 0}, {0, 1, 0}, 0.9,
                                 320, 200, 0.1, 100);
    Box box;
    const glm::dvec3 center(3 * u(rng), 2 * u(rng), 2 * u(rng));
    box.add(glm::vec3(center)),
        box.add(glm::vec3(center + glm::abs(glm::dvec3(u(rng), u(rng), u(rng)))));
    const auto camera = picture_camera(frame, box, {1.0, 512, 0.25});
    if (!camera) continue;
    ++made;
    ASSERT_TRUE(validate(*camera).ok());
    for (const glm::vec3& corner : box.corners()) {
      const glm::dvec3 raster = raster_from_world(*camera, corner);
      EXPECT_GE(raster.x, 1 - 1e-6);
      EXPECT_LE(raster.x, camera->width - 1 + 1e-6);
      EXPECT_GE(raster.y, 1 - 1e-6);
      EXPECT_LE(raster.y, camera->height - 1 + 1e-6);
    }
    // Brute force: neighbouring texels land at most a pixel apart, wherever the frame shows them.
    for (int k = 0; k < 40; ++k) {
      const glm::dvec2 at(camera->width * (0.5 + 0.5 * u(rng)),
                          camera->height * (0.5 + 0.5 * u(rng)));
      const auto in_frame = [&](const glm::dvec2& texel) {
        return raster_from_world(frame, world_from_raster(*camera, texel, camera->z_near));
      };
      const glm::dvec3 p = in_frame(at);
      if (p.z <= 0 || p.x < 0 || p.y < 0 || p.x > frame.width || p.y > frame.height) continue;
      for (const glm::dvec2& step : {glm::dvec2(1, 0), glm::dvec2(0, 1)}) {
        const glm::dvec3 q = in_frame(at + step);
        // 2 %: the step is taken at the texel, the bound at the bounds' rim.
        EXPECT_LT(glm::length(glm::dvec2(q) - glm::dvec2(p)), 1.02);
      }
    }
  }
  EXPECT_GT(made, 2000);
}

TEST(PictureCamera, refuses_an_eye_at_or_inside_the_bounds_and_pictures_too_large) {
  const Camera frame = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 0.9, 1280, 720, 0.1, 100);
  Box around;
  around.add({-5, -5, -5}), around.add({5, 5, 5});
  EXPECT_FALSE(picture_camera(frame, around));
  Box close;
  close.add({-1, -1, -1}), close.add({1, 1, 2.9f});
  EXPECT_FALSE(picture_camera(frame, close));
  Box fine;
  fine.add({-0.5f, -0.5f, -0.5f}), fine.add({0.5f, 0.5f, 0.5f});
  EXPECT_TRUE(picture_camera(frame, fine));
  EXPECT_FALSE(picture_camera(frame, fine, {1.0, 64, 0.25}));
  EXPECT_FALSE(picture_camera(frame, Box{}));
}

}  // namespace
}  // namespace rilievo

#include "rilievo/nailboard/nailboard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

Camera random_capture(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Box box;
  const glm::vec3 half(0.2f + std::abs(u(rng)), 0.2f + std::abs(u(rng)), 0.2f + std::abs(u(rng)));
  box.add(-half), box.add(half);
  const glm::dvec3 eye = glm::normalize(glm::dvec3(u(rng), u(rng), u(rng))) * (4.0 + u(rng));
  Camera camera = *tight_camera(Projection::perspective, eye, {0, 1, 0}, box);
  camera.width = 16, camera.height = 12;
  return camera;
}

TEST(NailboardDepth, exact_is_the_samples_own_depth_from_any_eye) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const PictureGeometry picture = picture_geometry(random_capture(rng));
    const Camera frame = look_at({8 * u(rng) - 4, 3, 6}, {0, 0, 0}, {0, 1, 0}, 1, 64, 48, 1, 30);
    // A point in the picture's frustum, projected by both cameras.
    const glm::dvec2 raster(16 * u(rng), 12 * u(rng));
    const double d = picture.slab.front + u(rng) * (picture.slab.back - picture.slab.front);
    const glm::dvec3 p = world_from_raster(picture.capture, raster, d);
    const double delta = depth_from_eye_z(DepthKind::window_z, d, picture.capture, raster);
    const double seen = raster_from_world(frame, p).z;
    const double expected = depth_from_eye_z(DepthKind::window_z, seen, frame, {});
    // Rounding of doubles, over a range of depths of 30 : 1.
    EXPECT_NEAR(exact_depth(picture, frame, raster, delta), expected, 1e-12);
  }
}

// Both window_z are affine in 1 / distance along a line of sight, so as long as the eye stays where
// it was, however it turns, eq. (4) is exact.
TEST(NailboardDepth, linear_is_exact_for_an_eye_that_only_turns) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const PictureGeometry picture = picture_geometry(random_capture(rng));
    const glm::dvec3 eye = picture.capture.position();
    const glm::dvec3 aside = 1.5 * glm::dvec3(u(rng) - 0.5, u(rng) - 0.5, u(rng) - 0.5);
    const Camera frame = look_at(eye, aside, {0.1, 1, 0}, 1.2, 64, 48, 1, 30);
    const glm::dvec2 raster(16 * u(rng), 12 * u(rng));
    const double delta = u(rng);
    EXPECT_NEAR(linear_depth(picture, frame, raster, delta),
                exact_depth(picture, frame, raster, delta), 1e-12);
  }
}

TEST(NailboardDepth, linear_ends_on_the_near_and_far_planes_and_flat_lies_between) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const PictureGeometry picture = picture_geometry(random_capture(rng));
    const glm::dvec3 eye = picture.capture.position() + 0.2 * glm::dvec3(u(rng), u(rng), u(rng));
    const Camera frame = look_at(eye, {0, 0, 0}, {0, 1, 0}, 1, 64, 48, 0.5, 30);
    const glm::dvec2 raster(16 * u(rng), 12 * u(rng));
    const double near = linear_depth(picture, frame, raster, 0);
    const double far = linear_depth(picture, frame, raster, 1);
    const double flat = flat_depth(picture, frame, raster);
    EXPECT_LT(near, flat);
    EXPECT_LT(flat, far);
  }
}

DepthImage random_picture(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(0, 1);
  DepthImage picture;
  picture.camera = random_capture(rng);
  const Camera& c = picture.camera;
  picture.color = ColorImage(c.width, c.height);
  picture.depth = Image<float>(c.width, c.height, kNoDepth);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; ++x) {
      if (rng() % 3 == 0) continue;
      const float alpha = float(1 + rng() % 4) / 4.0f;
      picture.color(x, y) = glm::vec4(u(rng), u(rng), u(rng), 1.0f) * alpha;
      picture.depth(x, y) = float(c.z_near + u(rng) * (c.z_far - c.z_near));
    }
  return picture;
}

TEST(Nailboard, keeps_colour_to_a_byte_and_depth_to_half_a_step) {
  std::mt19937 rng(4);
  int empty = 0;
  for (int bits : {2, 4, 6, 8, 16}) {
    DepthImage picture = random_picture(rng);
    for (int y = 3; y < 9; ++y)  // a hole in the middle
      for (int x = 4; x < 12; ++x)
        picture.color(x, y) = glm::vec4(0), picture.depth(x, y) = kNoDepth;
    const Nailboard board = make_nailboard(picture, bits);
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 16; ++x) {
        if (!picture.covered(x, y)) {
          ASSERT_EQ(board.color(x, y), glm::u8vec4(0));
          // As deep as the nearest around.
          unsigned nearest = delta_transparent(bits);
          for (int v = std::max(0, y - 1); v <= std::min(11, y + 1); ++v)
            for (int u = std::max(0, x - 1); u <= std::min(15, x + 1); ++u)
              if (picture.covered(u, v)) nearest = std::min<unsigned>(nearest, board.delta(u, v));
          ASSERT_EQ(board.delta(x, y), nearest);
          empty += nearest == delta_transparent(bits);
          continue;
        }
        const glm::vec4& c = picture.color(x, y);
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(board.color(x, y)[k] / 255.0f, srgb_from_linear(c[k] / c.a) * c.a,
                      0.5f / 255 + 1e-6f);
        const double z =
            depth_from_eye_z(DepthKind::window_z, picture.depth(x, y), picture.camera, {});
        // Half a step, and a float's rounding.
        EXPECT_NEAR(decode_delta(board.delta(x, y), bits), z, 0.5 / delta_steps(bits) + 1e-6);
      }
  }
  EXPECT_GE(empty, 5 * 4 * 6);
}

TEST(Nailboard, survives_the_way_to_a_picture_and_back_bit_for_bit) {
  std::mt19937 rng(5);
  for (int i = 0; i < 50; ++i)
    for (int bits : {2, 4, 6, 8, 16}) {
      const Nailboard board = make_nailboard(random_picture(rng), bits);
      const Nailboard again = make_nailboard(depth_image_from(board), bits);
      ASSERT_EQ(again.color, board.color);
      ASSERT_EQ(again.delta, board.delta);
    }
}

}  // namespace
}  // namespace rilievo

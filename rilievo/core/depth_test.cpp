#include "rilievo/core/depth.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo {
namespace {

TEST(Depth, every_kind_inverts) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 1000; ++i) {
    Camera c = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.2, 320, 200, 0.5, 50);
    if (i % 2) c.projection = Projection::parallel;
    const glm::dvec2 raster{u(rng) * 320, u(rng) * 200};
    const double d = 0.5 + u(rng) * 49.5;
    for (DepthKind kind : {DepthKind::window_z, DepthKind::eye_z, DepthKind::ray}) {
      const double back = eye_z_from(kind, depth_from_eye_z(kind, d, c, raster), c, raster);
      // window_z near the far plane loses digits by f / n = 100.
      EXPECT_NEAR(back, d, 1e-11);
    }
    const glm::dvec3 p = world_from_raster(c, raster, d);
    if (c.projection == Projection::perspective) {
      EXPECT_NEAR(depth_from_eye_z(DepthKind::ray, d, c, raster), glm::length(p), 1e-12);
    }
  }
}

TEST(Depth, nothing_stays_nothing) {
  const Camera c = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.2, 320, 200, 0.5, 50);
  for (DepthKind kind : {DepthKind::window_z, DepthKind::eye_z, DepthKind::ray}) {
    EXPECT_EQ(depth_from_eye_z(kind, kNoDepth, c, {1, 1}), kNoDepth);
    EXPECT_EQ(eye_z_from(kind, kNoDepth, c, {1, 1}), kNoDepth);
  }
}

TEST(Delta, every_code_survives_and_none_is_transparent) {
  for (int bits = 2; bits <= 16; ++bits)
    for (std::uint32_t code = 0; code < delta_transparent(bits); ++code)
      ASSERT_EQ(encode_delta(decode_delta(code, bits), bits), code) << bits << " bits";
}

TEST(Delta, rounds_to_the_nearest_of_the_evenly_spaced_codes) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<float> u(0, 1);
  for (int i = 0; i < 10000; ++i) {
    const int bits = 2 + i % 15;
    const float z = u(rng);
    const float back = decode_delta(encode_delta(z, bits), bits);
    // Half a step, and the rounding of a float near 1.
    EXPECT_LE(std::abs(back - z), 0.5f / float(delta_steps(bits)) + 1.2e-7f);
  }
}

}  // namespace
}  // namespace rilievo

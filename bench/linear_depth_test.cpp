#include "bench/linear_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/core/depth.h"

namespace rilievo::bench {
namespace {

struct Case {
  Camera capture, frame;
  glm::dvec2 raster;
  double delta = 0;
};

// A picture of 100 x 100 texels taken from anywhere, anyhow turned.
Case random_case(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Case c;
  const double d = std::exp(3 * unit(random));
  c.capture = look_at({10 * unit(random), 10 * unit(random), 10 * unit(random)},
                      {50 * unit(random), 50 * unit(random), 50 * unit(random)}, {0, 1, 0}, 0.6,
                      100, 100, d, d * (1.1 + std::abs(2 * unit(random))));
  c.frame = c.capture;
  c.frame.z_near = 0.1 * d;
  c.frame.z_far = 1000 * d;
  c.raster = {50 + 50 * unit(random), 50 + 50 * unit(random)};
  c.delta = 0.5 + 0.5 * unit(random);
  return c;
}

TEST(linear_depth, rotating_about_the_eye_leaves_rounding_errors_only) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    Case c = random_case(random);
    const glm::dvec3 axis = glm::normalize(glm::dvec3(unit(random), unit(random), 0.1));
    c.frame.world_from_eye = c.frame.world_from_eye * glm::rotate(glm::dmat4(1), 0.5, axis);
    const LinearDepth depth = linear_depth(c.capture, c.raster, c.delta, c.frame);
    // A window depth carries 1e-16, an eye distance eye_z / z_near times that: here below 1e3.
    EXPECT_NEAR(depth.linear_eye_z, depth.exact_eye_z, 1e-12 * depth.exact_eye_z);
    EXPECT_NEAR(depth.ray_eye_z, depth.exact_eye_z, 1e-12 * depth.exact_eye_z);
  }
}

// With the planes at n and f, and the eye moved along them by t, eq. (4) gives
//   1 / z = (1 - delta) / (n + t) + delta / (f + t)
// wherever the texel lies in the picture.
TEST(linear_depth, moving_along_the_axis_follows_the_closed_form) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    Case c = random_case(random);
    const double n = c.capture.z_near, f = c.capture.z_far, t = 0.5 * n * unit(random);
    c.frame.world_from_eye[3] -= glm::dvec4(c.capture.forward() * t, 0);
    const LinearDepth depth = linear_depth(c.capture, c.raster, c.delta, c.frame);
    EXPECT_NEAR(1 / depth.linear_eye_z, (1 - c.delta) / (n + t) + c.delta / (f + t), 1e-11 / n);
    const double z = eye_z_from(DepthKind::window_z, c.delta, c.capture, c.raster);
    EXPECT_NEAR(depth.exact_eye_z, z + t, 1e-11 * f);
    EXPECT_NEAR(depth.ray_eye_z, z + t, 1e-11 * f);
  }
}

// Both planes keep their depths, so the interpolation between them does too.
TEST(linear_depth, moving_across_without_turning_is_exact) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    Case c = random_case(random);
    const glm::dvec3 right = c.capture.world_from_eye[0];
    c.frame.world_from_eye[3] += glm::dvec4(right * (0.2 * unit(random) * c.capture.z_near), 0);
    const LinearDepth depth = linear_depth(c.capture, c.raster, c.delta, c.frame);
    EXPECT_NEAR(depth.linear_eye_z, depth.exact_eye_z, 1e-11 * depth.exact_eye_z);
  }
}

}  // namespace
}  // namespace rilievo::bench

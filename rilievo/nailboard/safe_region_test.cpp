#include "rilievo/nailboard/safe_region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rilievo {
namespace {

glm::dvec3 in_ball(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-1, 1);
  for (;;) {
    const glm::dvec3 p(u(rng), u(rng), u(rng));
    if (glm::dot(p, p) <= 1 && glm::dot(p, p) > 1e-6) return p;
  }
}

PictureGeometry random_geometry(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0, 1);
  const double size = std::pow(10.0, 2 * u(rng) - 1), distance = size * (1 + 20 * u(rng));
  Box box;
  box.add(glm::vec3(-0.5 * size)), box.add(glm::vec3(0.5 * size * u(rng)));
  const glm::dvec3 eye = glm::normalize(in_ball(rng)) * (distance + size);
  Camera capture = *tight_camera(Projection::perspective, eye, {0, 1, 0}, box);
  capture.width = 16 + int(rng() % 500), capture.height = 16 + int(rng() % 500);
  return picture_geometry(capture);
}

TEST(SafeRegion, no_frame_in_the_ball_is_worse_than_allowed) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(0, 1);
  int checked = 0;
  double largest_share = 0;
  for (int i = 0; i < 3000; ++i) {
    const PictureGeometry picture = random_geometry(rng);
    const Camera any = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.5 + u(rng), 640, 480,
                               0.1 * picture.slab.front, 100);
    const double allowed = 0.25 + 4 * u(rng);
    const SafeRegion region = safe_region(picture, any, corner_tan(any), allowed);
    if (region.radius < 0) {
      EXPECT_FALSE(contains(region, region.eye));
      EXPECT_GT(ball_error_px(picture, any, corner_tan(any), 0), allowed);
      continue;
    }
    for (int k = 0; k < 20; ++k) {
      glm::dvec3 offset = in_ball(rng) * region.radius;
      if (k % 2) offset = glm::normalize(offset) * (region.radius * (1 - 1e-9));
      ASSERT_TRUE(contains(region, region.eye + offset));
      const glm::dvec3 target = region.eye + picture.capture.forward() * picture.plane_z +
                                in_ball(rng) * (0.5 * picture.plane_z);
      Camera frame = any;
      frame.world_from_eye =
          look_at(region.eye + offset, target, in_ball(rng), 1, 1, 1, 1, 2).world_from_eye;
      const PictureError error = bound_error(picture, frame);
      ASSERT_LE(error.total_px, allowed * (1 + 1e-9)) << i;
      largest_share = std::max(largest_share, error.total_px / allowed);
      checked += error.in_frame;
    }
  }
  EXPECT_GT(checked, 20000);
  // Safe, and not needlessly small: some frame uses most of what is allowed.
  EXPECT_GT(largest_share, 0.7);
}

TEST(SafeRegion, is_the_largest_ball_of_its_bound) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const PictureGeometry picture = random_geometry(rng);
    const Camera frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1, 640, 480, 0.1, 100);
    const double tangent = u(rng), allowed = 4 * u(rng);
    const SafeRegion region = safe_region(picture, frame, tangent, allowed);
    if (region.radius < 0) continue;
    EXPECT_LE(ball_error_px(picture, frame, tangent, region.radius), allowed);
    const double beyond = region.radius * (1 + 1e-6) + 1e-9 * picture.slab.front;
    EXPECT_GT(ball_error_px(picture, frame, tangent, beyond), allowed);
    double last = 0;
    for (int k = 0; k <= 20; ++k) {  // grows with the offset, without which bisection is wrong
      const double now = ball_error_px(picture, frame, tangent, picture.slab.front * k / 20.0);
      EXPECT_GE(now, last);
      last = now;
    }
    EXPECT_TRUE(std::isinf(last));
  }
}

TEST(SafeRegion, expected_lifetime_ends_where_the_eye_leaves) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const SafeRegion region{100.0 * in_ball(rng), 10 * u(rng)};
    const glm::dvec3 eye = region.eye + in_ball(rng) * region.radius;
    const glm::dvec3 velocity = in_ball(rng) * std::pow(10.0, -3 + 4 * u(rng));
    const double lifetime = expected_lifetime(region, eye, velocity);
    ASSERT_TRUE(std::isfinite(lifetime));
    ASSERT_GE(lifetime, 0);
    // 1e-9: rounding of positions of 100 m in doubles.
    EXPECT_NEAR(glm::length(eye + velocity * lifetime - region.eye), region.radius, 1e-9);
    EXPECT_TRUE(contains(region, eye + velocity * (lifetime * 0.999)));
    EXPECT_EQ(expected_lifetime(region, region.eye + glm::dvec3(region.radius * 1.01 + 1e-6, 0, 0),
                                velocity),
              0);
  }
  EXPECT_TRUE(std::isinf(expected_lifetime({{0, 0, 0}, 1}, {0.5, 0, 0}, {0, 0, 0})));
}

}  // namespace
}  // namespace rilievo

#include "rilievo/warp/parallax.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

glm::dvec3 in_ball(std::mt19937& rng, double radius) {
  std::uniform_real_distribution<double> u(-1, 1);
  for (;;) {
    const glm::dvec3 p(u(rng), u(rng), u(rng));
    if (glm::dot(p, p) <= 1) return p * radius;
  }
}

DepthSlab random_slab(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0, 1);
  const double front = std::pow(10.0, 3 * u(rng) - 1);
  return {front, front * (1 + std::pow(10.0, 4 * u(rng) - 3))};
}

TEST(Parallax, no_eye_inside_the_ball_sees_more_and_one_sees_as_much) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 500; ++i) {
    const DepthSlab slab = random_slab(rng);
    const double radius = slab.front * 0.95 * u(rng);
    const double bound = max_parallax(slab, radius);
    for (int k = 0; k < 50; ++k) {
      const glm::dvec3 ray(0.6 * u(rng) - 0.3, 0.6 * u(rng) - 0.3, -1);
      const glm::dvec3 eye = in_ball(rng, radius);
      // 1e-12: rounding of a dozen operations in doubles.
      EXPECT_LE(angle_between(ray * slab.front - eye, ray * slab.back - eye), bound + 1e-12);
    }
    // On the axis a fine sweep of the circle finds the bound: exact, not only safe.
    double seen = 0;
    for (int k = 0; k <= 20000; ++k) {
      const double a = std::acos(-1.0) * k / 20000;
      const glm::dvec3 eye = radius * glm::dvec3(std::sin(a), 0, -std::cos(a));
      seen = std::max(seen, angle_between(glm::dvec3(0, 0, -slab.front) - eye,
                                          glm::dvec3(0, 0, -slab.back) - eye));
    }
    EXPECT_GE(seen, bound * (1 - 1e-4));  // the sweep's step misses the top by that much at most
  }
}

TEST(Parallax, best_plane_balances_the_ends_of_the_slab) {
  std::mt19937 rng(2);
  for (int i = 0; i < 500; ++i) {
    const DepthSlab slab = random_slab(rng);
    const double plane = best_plane(slab);
    ASSERT_LE(slab.front, plane);
    ASSERT_LE(plane, slab.back);
    // In the limit of small offsets, where the two sides of the best plane are alike and any other
    // plane has one side that is worse. The offset's square enters with 1e-8.
    const double offset = 1e-4 * slab.front;
    const double best = max_flat_parallax(slab, plane, offset);
    EXPECT_NEAR(
        max_parallax({slab.front, plane}, offset) / max_parallax({plane, slab.back}, offset), 1,
        1e-6);
    for (double other : {0.9, 0.99, 1.01, 1.1}) {
      const double z = plane * other;
      if (z < slab.front || z > slab.back) continue;
      EXPECT_GT(max_flat_parallax(slab, z, offset), best);
    }
  }
}

TEST(Parallax, radius_is_the_inverse) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 2000; ++i) {
    const DepthSlab slab = random_slab(rng);
    const double angle = std::pow(10.0, -4 + 4 * u(rng));  // 1e-4 ... 1 radian
    const double radius = parallax_radius(slab, angle);
    ASSERT_LT(radius, slab.front);
    EXPECT_NEAR(max_parallax(slab, radius) / angle, 1, 1e-9);
    const double plane = best_plane(slab);
    const double flat = flat_parallax_radius(slab, plane, angle);
    EXPECT_GE(flat, radius);  // a plane in the middle is never worse than one at an end
    EXPECT_NEAR(max_flat_parallax(slab, plane, flat) / angle, 1, 1e-9);
  }
  EXPECT_EQ(parallax_radius({2, 2}, 0.01), 2);  // nothing is deep: good up to the picture
  EXPECT_EQ(parallax_radius({2, 3}, 0), 0);
}

TEST(Parallax, known_eye_is_bounded_and_never_worse_than_the_ball) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> u(0, 1);
  double along = 0;
  for (int i = 0; i < 3000; ++i) {
    const DepthSlab slab = random_slab(rng);
    const double plane = slab.front + u(rng) * (slab.back - slab.front);
    const ImageWindow window{-0.4 * u(rng), 0.4 * u(rng), -0.4 * u(rng), 0.4 * u(rng)};
    const glm::dvec3 eye = in_ball(rng, 0.9 * slab.front);
    const double bound = max_flat_parallax(slab, plane, window, eye);
    EXPECT_LE(bound, max_flat_parallax(slab, plane, glm::length(eye)));
    for (int k = 0; k < 30; ++k) {
      const glm::dvec3 ray(window.left + u(rng) * (window.right - window.left),
                           window.bottom + u(rng) * (window.top - window.bottom), -1);
      // Samples pile up at the ends, where the worst are.
      const double d = k % 3 == 0   ? slab.front
                       : k % 3 == 1 ? slab.back
                                    : slab.front + u(rng) * (slab.back - slab.front);
      EXPECT_LE(angle_between(ray * plane - eye, ray * d - eye), bound + 1e-12);
    }
    // Straight ahead through a narrow window: a small part of the ball's bound.
    const double ahead = 0.1 * slab.front;
    along =
        std::max(along, max_flat_parallax(slab, plane, {-0.01, 0.01, -0.01, 0.01}, {0, 0, -ahead}) /
                            max_flat_parallax(slab, plane, ahead));
  }
  EXPECT_LT(along, 0.05);
}

TEST(Parallax, the_corner_farthest_off_axis_may_be_at_any_border) {
  Camera frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.8, 100, 100, 0.1, 100);
  for (const ImageWindow& window :
       {ImageWindow{-0.7, 0.2, -0.1, 0.3}, ImageWindow{-0.2, 0.7, -0.1, 0.3},
        ImageWindow{-0.2, 0.7, -0.3, 0.1}, ImageWindow{-0.7, 0.1, -0.3, 0.2}}) {
    frame.window = window;
    EXPECT_DOUBLE_EQ(corner_tan(frame), std::hypot(0.7, 0.3));
  }
}

TEST(Parallax, pixels_from_angle_bounds_every_direction) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0, 1);
  for (int i = 0; i < 20000; ++i) {
    Camera frame = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.5 + u(rng), 1280, 720, 0.1, 100);
    if (i % 2) frame.window.left *= 0.5;  // off-axis
    const ImageWindow& w = frame.window;
    const double off_axis = corner_tan(frame);
    const glm::dvec3 a(w.left + u(rng) * (w.right - w.left), w.bottom + u(rng) * (w.top - w.bottom),
                       -1);
    // A direction at `angle` from a.
    const double angle = 0.3 * u(rng) * u(rng);
    const glm::dvec3 side = glm::normalize(glm::cross(a, in_ball(rng, 1)));
    const glm::dvec3 b = glm::normalize(a) * std::cos(angle) + side * std::sin(angle);
    const double bound = pixels_from_angle(frame, off_axis, angle);
    if (b.z >= 0) {
      EXPECT_TRUE(std::isinf(bound));
      continue;
    }
    const glm::dvec2 pa(raster_from_world(frame, a)), pb(raster_from_world(frame, b));
    EXPECT_LE(glm::length(pa - pb), bound * (1 + 1e-9) + 1e-9);
    if (std::isinf(bound)) continue;
    EXPECT_NEAR(angle_from_pixels(frame, off_axis, bound), angle, 1e-9);
  }
}

}  // namespace
}  // namespace rilievo

#include "rilievo/scene/far_origin.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo {
namespace {

std::vector<glm::dvec3> cloud(const glm::dvec3& center, double radius, std::size_t count,
                              unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(center + radius * glm::dvec3(u(rng), u(rng), u(rng)));
  return points;
}

TEST(FarOrigin, what_floats_serve_keeps_its_coordinates) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> place(-5, 5), size(-3, 6);
    const double radius = std::pow(10.0, size(rng));
    const glm::dvec3 center = radius * glm::dvec3(place(rng), place(rng), place(rng));
    EXPECT_EQ(far_origin(cloud(center, radius, 300, seed)), glm::dvec3(0)) << seed;
  }
  EXPECT_EQ(far_origin({}), glm::dvec3(0));
}

// Whatever the unit: what is left are coordinates as small as the cloud, and the origin has few
// digits.
TEST(FarOrigin, what_is_far_gets_an_origin_in_its_middle) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> place(-1, 1), size(-4, 4), distance(3, 8);
    const double radius = std::pow(10.0, size(rng));
    const glm::dvec3 center = std::pow(10.0, distance(rng)) * radius *
                              glm::normalize(glm::dvec3(place(rng), place(rng), place(rng)));
    std::vector<glm::dvec3> points = cloud(center, radius, 300, seed);
    const glm::dvec3 origin = far_origin(points);
    EXPECT_LT(glm::distance(origin, center), 2 * radius) << seed;
    for (const glm::dvec3& p : points)
      // Floats round to 6e-8 of up to 4 radii.
      EXPECT_LT(glm::distance(glm::dvec3(glm::vec3(p - origin)), p - origin), 1e-6 * radius);
  }
}

TEST(FarOrigin, a_few_marks_elsewhere_do_not_count) {
  const glm::dvec3 center(4.7e5, 412, -5.4e6);
  std::vector<glm::dvec3> points = cloud(center, 10, 96, 1);
  points.push_back(glm::dvec3(0));
  points.push_back(glm::dvec3(1e7));
  EXPECT_LT(glm::distance(far_origin(points), center), 20);
  EXPECT_LT(glm::distance(far_origin({center}), center), 1);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/scene/mesh_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

struct Surface {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
};

// Triangles between random points: loose ones, or neighbours with common corners.
Surface random_surface(Random& random, int triangles, bool loose) {
  Surface surface;
  const int points = loose ? 3 * triangles : std::max(3, triangles);
  for (int i = 0; i < points; ++i)
    surface.positions.emplace_back(random.between(-1, 1), random.between(-1, 1),
                                   random.between(-0.3f, 0.3f));
  for (int t = 0; t < triangles; ++t)
    for (int k = 0; k < 3; ++k)
      surface.indices.push_back(std::uint32_t(loose ? 3 * t + k : random.below(points)));
  return surface;
}

// The slow twin: the distance of a point from a triangle as the least over its plane's foot, if it
// is inside, and its edges.
double slow_distance(const glm::dvec3& p, const std::array<glm::dvec3, 3>& c) {
  double least = INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 a = c[i], edge = c[(i + 1) % 3] - a;
    const double length = glm::dot(edge, edge);
    const double at = length > 0 ? glm::clamp(glm::dot(p - a, edge) / length, 0.0, 1.0) : 0;
    least = std::min(least, glm::length(a + at * edge - p));
  }
  const glm::dvec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
  if (!(glm::dot(n, n) > 0)) return least;
  const glm::dvec3 foot = p - n * (glm::dot(p - c[0], n) / glm::dot(n, n));
  for (std::size_t i = 0; i < 3; ++i)
    if (glm::dot(glm::cross(c[(i + 1) % 3] - c[i], foot - c[i]), n) < 0) return least;
  return std::min(least, glm::length(foot - p));
}

double slow_distance(const glm::dvec3& p, const Surface& s) {
  double least = INFINITY;
  for (std::size_t t = 0; t < s.indices.size(); t += 3)
    least = std::min(least, slow_distance(p, {glm::dvec3(s.positions[s.indices[t]]),
                                              glm::dvec3(s.positions[s.indices[t + 1]]),
                                              glm::dvec3(s.positions[s.indices[t + 2]])}));
  return least;
}

// The largest over a grid of points of each triangle.
double slow_farthest(const Surface& from, const Surface& to, int steps) {
  double largest = 0;
  for (std::size_t t = 0; t < from.indices.size(); t += 3)
    for (int i = 0; i <= steps; ++i)
      for (int k = 0; k <= steps - i; ++k) {
        const double u = double(i) / steps, v = double(k) / steps;
        const glm::dvec3 p = (1 - u - v) * glm::dvec3(from.positions[from.indices[t]]) +
                             u * glm::dvec3(from.positions[from.indices[t + 1]]) +
                             v * glm::dvec3(from.positions[from.indices[t + 2]]);
        largest = std::max(largest, slow_distance(p, to));
      }
  return largest;
}

DistanceBounds bounds_of(const Surface& from, const Surface& to, const DistanceOptions& options) {
  const TriangleTree tree(to.positions, to.indices);
  return farthest_from(tree, from.positions, from.indices, to.indices.size() / 3, options);
}

TEST(TriangleTree, finds_the_nearest_of_random_triangles) {
  Random random(3);
  for (int round = 0; round < 60; ++round) {
    const Surface surface = random_surface(random, 1 + random.below(60), round % 2 == 0);
    const TriangleTree tree(surface.positions, surface.indices);
    for (int i = 0; i < 40; ++i) {
      const glm::dvec3 p(random.between(-2, 2), random.between(-2, 2), random.between(-2, 2));
      const TriangleTree::Nearest found = tree.nearest(p);
      // Doubles lose a few of their 16 digits.
      EXPECT_NEAR(std::sqrt(found.square), slow_distance(p, surface), 1e-9);
      EXPECT_EQ(found.square, tree.square_distance(p, found.triangle));
    }
  }
}

TEST(FarthestFrom, is_above_all_sampled_distances_and_near_the_largest) {
  Random random(4);
  for (int round = 0; round < 60; ++round) {
    const Surface from = random_surface(random, 1 + random.below(8), round % 2 == 0),
                  to = random_surface(random, 1 + random.below(12), round % 3 == 0);
    DistanceOptions options;
    options.work = 1e6;
    const DistanceBounds bounds = bounds_of(from, to, options);
    constexpr int kSteps = 40;
    const double sampled = slow_farthest(from, to, kSteps);
    EXPECT_GE(bounds.upper, sampled - 1e-9) << round;
    EXPECT_LE(bounds.upper, (1 + options.share) * bounds.lower + 1e-12) << round;
    // Between its points a grid misses at most the way to the next one: an edge is up to 2.9.
    EXPECT_LE(bounds.lower, sampled + 2.9 / kSteps) << round;
  }
}

TEST(FarthestFrom, ends_with_a_bound_however_little_work_is_allowed) {
  Random random(5);
  for (int round = 0; round < 40; ++round) {
    const Surface from = random_surface(random, 1 + random.below(8), true),
                  to = random_surface(random, 1 + random.below(12), true);
    const double sampled = slow_farthest(from, to, 30);
    double last = INFINITY;
    for (const double work : {0.0, 0.5, 4.0, 64.0}) {
      DistanceOptions options;
      options.work = work;
      const DistanceBounds bounds = bounds_of(from, to, options);
      EXPECT_GE(bounds.upper, sampled - 1e-9);
      EXPECT_LE(bounds.upper, last + 1e-12);  // more work does not lead to less
      last = bounds.upper;
      options.too_far = 0;
      EXPECT_GE(bounds_of(from, to, options).upper, sampled - 1e-9);
    }
  }
}

// A square in another's plane, of other triangles: nothing is away from anything.
TEST(FarthestFrom, of_the_same_surface_in_other_triangles_is_its_slack) {
  Surface square, parts;
  square.positions = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  square.indices = {0, 1, 2, 0, 2, 3};
  parts.positions = square.positions;
  parts.positions.emplace_back(0.3f, 0.6f, 1.0f);
  parts.indices = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
  DistanceOptions options;
  options.slack = 0.01, options.work = 1e4;
  for (const auto& [from, to] : {std::pair(square, parts), std::pair(parts, square)}) {
    const DistanceBounds bounds = bounds_of(from, to, options);
    EXPECT_LE(bounds.lower, 1e-9);
    EXPECT_LE(bounds.upper, options.slack + 1e-9);
  }
  options.work = 0;
  EXPECT_GT(bounds_of(square, parts, options).upper, 0.1);  // one triangle of it
}

}  // namespace
}  // namespace rilievo

#include "rilievo/environment_nodes/error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

NodeMesh coarse_mesh(const EnvironmentMap& map, std::size_t triangles) {
  TriangulateOptions options;
  options.triangles = triangles;
  options.error_px = 0;
  return triangulate(map, options);
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

TEST(SeenDisparity, is_what_a_triangle_at_a_time_says) {
  const EnvironmentMap map = make_node(40, furnished_room());
  const NodeMesh mesh = coarse_mesh(map, 300);
  for (int f = 0; f < 6; ++f) {
    const Image<float> fast = seen_disparity(mesh, f), slow = drawn_disparity(mesh, f);
    for (std::size_t i = 0; i < fast.texels().size(); ++i)
      // Centres on edges belong to both triangles, up to rounding of doubles.
      EXPECT_NEAR(fast.texels()[i], slow.texels()[i], 1e-5f) << f << " " << i;
  }
}

TEST(NodeBound, nothing_moves_for_the_nodes_own_eye) {
  const EnvironmentMap map = make_node(32, furnished_room(), nullptr, {7, 1, -3});
  const NodeErrorModel model = make_error_model(map, coarse_mesh(map, 200));
  const NodeBound none = bound(model, {7, 1, -3});
  EXPECT_EQ(none.error, 0);
  EXPECT_EQ(none.gap, 0);
}

// Every sample and its place on the mesh, every skin's ends, seen from random eyes.
TEST(NodeBound, holds_for_every_sample_and_gap_from_random_eyes) {
  const EnvironmentMap map = make_node(48, furnished_room());
  for (const std::size_t triangles : {150, 600}) {
    const NodeMesh mesh = coarse_mesh(map, triangles);
    const NodeErrorModel model = make_error_model(map, mesh);
    const CubeGrid grid(map, {});
    std::array<Image<float>, 6> seen;
    for (int f = 0; f < 6; ++f) seen[std::size_t(f)] = seen_disparity(mesh, f);
    Random random(triangles);
    int useful = 0;
    for (int i = 0; i < 100; ++i) {
      const double reach = i % 2 ? 0.1 : 1.5;
      const auto in = [&] { return reach * double(random.between(-1, 1)); };
      const glm::dvec3 eye(in(), in(), in());
      const NodeBound limit = bound(model, eye);
      double largest = 0, widest = 0;
      for (int f = 0; f < 6; ++f)
        for (int y = 0; y < 48; ++y)
          for (int x = 0; x < 48; ++x) {
            const float sample = grid.at(f, {x, y}), drawn = seen[std::size_t(f)](x, y);
            const glm::dvec3 c = glm::dvec3(grid.key(f, {2 * x + 1, 2 * y + 1})) / 48.0;
            largest =
                std::max(largest, angle_between(c / double(sample) - eye, c / double(drawn) - eye));
          }
      for (std::size_t t = mesh.surface_triangles(); t < mesh.triangles(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
          const NodeVertex& a = mesh.vertices[mesh.indices[3 * t + k]];
          const NodeVertex& b = mesh.vertices[mesh.indices[3 * t + (k + 1) % 3]];
          if (a.direction != b.direction) continue;
          const glm::dvec3 c(a.direction);
          widest = std::max(
              widest, angle_between(c / double(a.disparity) - eye, c / double(b.disparity) - eye));
        }
      // Floats in the model: a millionth.
      EXPECT_LE(largest, limit.error * (1 + 1e-5) + 1e-6);
      EXPECT_LE(widest, limit.gap * (1 + 1e-5) + 1e-6);
      useful += limit.error < 20 * largest;
    }
    // It says something: for most eyes it is within an order of magnitude or so.
    EXPECT_GT(useful, 50);
  }
}

// The widest angle between what lies on one line of sight of the node, all along its skins: on
// every line of sight, all edges of skins that cross it are there.
double widest_gap(const NodeMesh& mesh, const glm::dvec3& eye) {
  using Ends = std::array<float, 6>;
  std::map<Ends, std::vector<glm::dvec2>> edges;
  for (std::size_t t = mesh.surface_triangles(); t < mesh.triangles(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const NodeVertex& a = mesh.vertices[mesh.indices[3 * t + k]];
      const NodeVertex& b = mesh.vertices[mesh.indices[3 * t + (k + 1) % 3]];
      const glm::vec3 &u = a.direction, &v = b.direction;
      const Ends there{u.x, u.y, u.z, v.x, v.y, v.z}, back{v.x, v.y, v.z, u.x, u.y, u.z};
      if (there <= back) edges[there].push_back({a.disparity, b.disparity});
      if (back <= there) edges[back].push_back({b.disparity, a.disparity});
    }
  double widest = 0;
  for (const auto& [ends, disparities] : edges)
    for (int i = 0; i <= 64; ++i) {
      const double t = i / 64.0;
      const glm::dvec3 c =
          glm::mix(glm::dvec3(ends[0], ends[1], ends[2]), glm::dvec3(ends[3], ends[4], ends[5]), t);
      double low = 1e30, high = 0;
      for (const glm::dvec2& d : disparities) {
        low = std::min(low, glm::mix(d.x, d.y, t));
        high = std::max(high, glm::mix(d.x, d.y, t));
      }
      // c - d eye: a place at disparity d, seen from the eye; it may be infinitely far.
      widest = std::max(widest, angle_between(c - low * eye, c - high * eye));
    }
  return widest;
}

// A silhouette that is straight is one edge from border to border of a face.
TEST(NodeBound, holds_in_the_middle_of_a_long_silhouette) {
  const EnvironmentMap map = make_node(64, [](const glm::dvec3& d) {
    const double aside = std::max(std::abs(d.x), std::abs(d.y));
    return (d.x > 0 && -d.z > aside ? 1.0 : 10.0) / std::max(std::abs(d.z), aside);
  });
  const NodeMesh mesh = coarse_mesh(map, 200);
  const glm::dvec3 eye(0.3, 0, 0);
  const double gap = std::atan(0.3) - std::atan(0.03);
  EXPECT_NEAR(widest_gap(mesh, eye), gap, 1e-6);
  const NodeBound limit = bound(make_error_model(map, mesh), eye);
  EXPECT_GE(limit.gap, gap);
  EXPECT_LE(limit.gap, 1.5 * gap);
}

// Long boards hang before the walls, some of them slanted: silhouettes cross whole faces, as far
// from the node everywhere or near at one end and far at the other.
TEST(NodeBound, holds_all_along_the_gaps_of_random_boards_from_random_eyes) {
  Random random(11);
  const auto any = [&] {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    return glm::dvec3(x, y, z);
  };
  int useful = 0, eyes = 0;
  for (int i = 0; i < 16; ++i) {
    std::vector<DistanceAlong> all{box_around({-4, -3, -5}, {5, 4, 3})};
    for (int k = 0; k < 2; ++k) {
      const double tilt = random.below(2) ? 0.5 : 0.0;
      glm::dvec3 normal(0), side(0);
      normal[int(random.below(3))] = random.below(2) ? 1 : -1;
      side = glm::normalize(glm::dvec3(normal.y, normal.z, normal.x) + tilt * any());
      normal = glm::normalize(normal + tilt * any());
      const glm::dvec3 up = glm::normalize(glm::cross(side, normal));
      const glm::dvec3 center = (0.6 + 0.8 * k) * normal + 0.3 * any();
      all.push_back([=](const glm::dvec3& d) {
        const double t = glm::dot(center, normal) / glm::dot(d, normal);
        const bool hit = t > 0.1 && std::abs(glm::dot(t * d - center, up)) < 0.2;
        return hit ? t : std::numeric_limits<double>::infinity();
      });
    }
    const EnvironmentMap map = make_node(48, nearest_of(all));
    const NodeMesh mesh = coarse_mesh(map, i % 2 ? 300 : 1500);
    const NodeErrorModel model = make_error_model(map, mesh);
    for (int e = 0; e < 8; ++e) {
      const glm::dvec3 eye = (e % 2 ? 0.05 : 0.2) * any();
      const double limit = bound(model, eye).gap, widest = widest_gap(mesh, eye);
      EXPECT_LE(widest, limit * (1 + 1e-5) + 1e-6);  // floats in the model
      useful += limit < 2 * widest;
      ++eyes;
    }
  }
  EXPECT_GT(useful, eyes / 2);
}

TEST(NodeBound, an_eye_at_a_surface_has_no_bound) {
  const EnvironmentMap map = make_node(32, furnished_room());
  const NodeErrorModel model = make_error_model(map, coarse_mesh(map, 200));
  // Inside the first ball.
  EXPECT_GT(bound(model, {1.4, -0.5, -1.3}).error, 0.5);
}

}  // namespace
}  // namespace rilievo

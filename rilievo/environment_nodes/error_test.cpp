#include "rilievo/environment_nodes/error.h"

#include <gtest/gtest.h>

#include <cmath>

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
    const auto angle = [](const glm::dvec3& a, const glm::dvec3& b) {
      return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    };
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
            largest = std::max(largest, angle(c / double(sample) - eye, c / double(drawn) - eye));
          }
      for (std::size_t t = mesh.surface_triangles(); t < mesh.triangles(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
          const NodeVertex& a = mesh.vertices[mesh.indices[3 * t + k]];
          const NodeVertex& b = mesh.vertices[mesh.indices[3 * t + (k + 1) % 3]];
          if (a.direction != b.direction) continue;
          const glm::dvec3 c(a.direction);
          widest =
              std::max(widest, angle(c / double(a.disparity) - eye, c / double(b.disparity) - eye));
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

TEST(NodeBound, an_eye_at_a_surface_has_no_bound) {
  const EnvironmentMap map = make_node(32, furnished_room());
  const NodeErrorModel model = make_error_model(map, coarse_mesh(map, 200));
  // Inside the first ball.
  EXPECT_GT(bound(model, {1.4, -0.5, -1.3}).error, 0.5);
}

}  // namespace
}  // namespace rilievo

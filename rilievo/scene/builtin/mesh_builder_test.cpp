#include "rilievo/scene/builtin/mesh_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

// Volume inside a closed mesh by the divergence theorem; negative if it is inside out.
double volume(const Mesh& mesh) {
  double six = 0.0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
        c(mesh.positions[mesh.indices[i + 2]]);
    six += glm::dot(a, glm::cross(b, c));
  }
  return six / 6.0;
}

// Every directed edge once, and its opposite once: closed, and turned the same way everywhere.
bool closed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    for (int k = 0; k < 3; ++k) ++edges[{mesh.indices[i + k], mesh.indices[i + (k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    if (count != 1 || opposite == edges.end() || opposite->second != 1) return false;
  }
  return !edges.empty();
}

TEST(MeshBuilder, a_blob_is_a_closed_ball_with_normals_outwards) {
  for (int n = 1; n <= 12; ++n) {
    Mesh mesh;
    add_blob(mesh, n, [](const glm::vec3& d) { return BuiltVertex{2.0f * d}; });
    EXPECT_EQ(mesh.triangles(), std::uint64_t(8 * n * n));
    EXPECT_TRUE(closed(mesh));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
      EXPECT_NEAR(glm::length(mesh.positions[i]), 2.0f, 1e-6f);
      // A facet of about 90 / n degrees leans from the ball's normal by half of that at most.
      EXPECT_GT(glm::dot(mesh.normals[i], mesh.positions[i]) / 2.0f, std::cos(0.79f / n));
    }
    // From the octahedron (4/3) towards the ball (4.19), times 2^3, growing.
    EXPECT_GT(volume(mesh), 8 * (4.0 / 3.0) - 1e-5);
    EXPECT_LT(volume(mesh), 8 * 4.1888);
    if (n == 12) {
      EXPECT_GT(volume(mesh), 8 * 4.1888 * 0.98);
    }
  }
}

TEST(MeshBuilder, a_box_is_closed_and_a_rounded_one_lies_in_it) {
  std::mt19937 rng(1);
  for (int i = 0; i < 50; ++i) {
    BoxShape shape;
    shape.n = {1 + int(rng() % 6), 1 + int(rng() % 6), 1 + int(rng() % 6)};
    const glm::vec3 half{0.5f + rng() % 3, 0.5f + rng() % 3, 0.5f + rng() % 3};
    Mesh sharp, round;
    add_box(sharp, shape, [&](const glm::vec3& c) { return BuiltVertex{c * half}; });
    add_box(round, shape,
            [&](const glm::vec3& c) { return BuiltVertex{rounded_box(c, half, 0.2f, shape.n)}; });
    EXPECT_EQ(sharp.triangles(), std::uint64_t(shape.triangles()));
    EXPECT_TRUE(closed(sharp));
    EXPECT_NEAR(volume(sharp), 8.0 * half.x * half.y * half.z, 1e-3);
    EXPECT_GT(volume(round), 0.0);
    EXPECT_LT(volume(round), volume(sharp));
    for (const glm::vec3& p : round.positions)
      EXPECT_TRUE(glm::all(glm::lessThanEqual(glm::abs(p), half + 1e-5f)));
  }
  BoxShape open;
  open.bottom = open.back = false;
  Mesh mesh;
  add_box(mesh, open, [](const glm::vec3& c) { return BuiltVertex{c}; });
  EXPECT_EQ(mesh.triangles(), 8u);
  EXPECT_EQ(open.triangles(), 8);
}

TEST(MeshBuilder, a_grid_closed_both_ways_is_a_torus) {
  GridShape shape;
  shape.nu = 40, shape.nv = 24, shape.closed_u = shape.closed_v = true;
  Mesh mesh;
  add_grid(mesh, shape, [](float u, float v) {
    const float a = 6.2831853f * u, b = 6.2831853f * v, r = 3.0f + std::cos(b);
    return BuiltVertex{{r * std::sin(a), std::sin(b), r * std::cos(a)}};
  });
  EXPECT_EQ(mesh.triangles(), std::uint64_t(shape.triangles()));
  EXPECT_TRUE(closed(mesh));
  // 2 pi^2 R r^2 = 59.2; the inscribed polyhedron lacks a few percent.
  EXPECT_GT(volume(mesh), 59.2 * 0.95);
  EXPECT_LT(volume(mesh), 59.22);
}

TEST(MeshBuilder, a_grid_with_poles_is_closed) {
  GridShape shape;
  shape.nu = 7, shape.nv = 5, shape.closed_u = shape.pole_at_start = shape.pole_at_end = true;
  Mesh mesh;
  add_grid(mesh, shape, [](float u, float v) {
    const float a = 6.2831853f * u, b = 3.1415927f * v;
    return BuiltVertex{{std::sin(b) * std::sin(a), -std::cos(b), std::sin(b) * std::cos(a)}};
  });
  EXPECT_EQ(mesh.triangles(), std::uint64_t(shape.triangles()));
  EXPECT_TRUE(closed(mesh));
  EXPECT_GT(volume(mesh), 0.0);
}

TEST(MeshBuilder, a_tube_looks_outwards) {
  Mesh mesh;
  add_tube(mesh, {1, 2, 3}, {2, 5, 1}, 0.5f, 0.2f, 8, 3, glm::vec3(1));
  EXPECT_EQ(mesh.triangles(), 48u);
  const glm::vec3 a{1, 2, 3}, axis = glm::normalize(glm::vec3(1, 3, -2));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i] - a, out = p - axis * glm::dot(p, axis);
    EXPECT_GT(glm::dot(mesh.normals[i], glm::normalize(out)), 0.9f);
  }
}

TEST(MeshBuilder, a_budget_is_met_over_many_pieces) {
  std::mt19937 rng(2);
  for (int trial = 0; trial < 50; ++trial) {
    TriangleBudget budget;
    double wanted = 0, got = 0, largest = 0;
    for (int i = 0; i < 40; ++i) {
      const double target = 20 + double(rng() % 2000);
      const int n = budget.divide(target, 8, 5, 1);
      wanted += target, got += 8.0 * n * n + 5.0 * n;
      largest = std::max(largest, 8.0 * (2 * n + 1) + 5);
    }
    // What is owed at the end is at most one step of the finest piece.
    EXPECT_NEAR(got, wanted, largest);
  }
}

TEST(Random, noise_is_continuous_bounded_and_depends_on_the_seed) {
  Random random(3);
  float low = 1, high = -1;
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 p{random.between(-9, 9), random.between(-9, 9), random.between(-9, 9)};
    const float v = noise(p, 7);
    low = std::min(low, v), high = std::max(high, v);
    // The slope of smoothstep is 1.5 at most, values differ by 2 at most, three axes.
    EXPECT_NEAR(noise(p + glm::vec3(1e-3f), 7), v, 9.1e-3f);
  }
  EXPECT_GE(low, -1.0f);
  EXPECT_LT(low, -0.7f);
  EXPECT_LE(high, 1.0f);
  EXPECT_GT(high, 0.7f);
  EXPECT_NE(noise({0.5f, 0.5f, 0.5f}, 7), noise({0.5f, 0.5f, 0.5f}, 8));
}

TEST(Random, is_even_and_repeats) {
  Random a(5), b(5);
  int counts[7] = {};
  double sum = 0;
  for (int i = 0; i < 70000; ++i) {
    ++counts[a.below(7)];
    sum += a.unit();
    (void)b.next(), (void)b.next();
  }
  // Standard deviation of a count: sqrt(70000 * 6 / 49) = 93; of the mean: 0.0011. Five of each.
  for (int count : counts) EXPECT_NEAR(count, 10000, 465);
  EXPECT_NEAR(sum / 70000, 0.5, 0.0055);
  EXPECT_EQ(a.next(), b.next());
}

}  // namespace
}  // namespace rilievo

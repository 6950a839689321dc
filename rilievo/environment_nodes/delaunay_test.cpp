#include "rilievo/environment_nodes/delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

using Points = std::vector<glm::ivec2>;
using Triangle = Delaunay::Triangle;

std::int64_t total_area(const Delaunay& mesh) {
  std::int64_t sum = 0;
  for (const Triangle& t : mesh.triangles())
    sum += orientation(mesh.points()[t.v[0]], mesh.points()[t.v[1]], mesh.points()[t.v[2]]);
  return sum;
}

// Neighbours know each other by the same edge, and agree on what is fixed.
void expect_linked(const Delaunay& mesh) {
  for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
    const Triangle& t = mesh.triangles()[i];
    ASSERT_GT(orientation(mesh.points()[t.v[0]], mesh.points()[t.v[1]], mesh.points()[t.v[2]]), 0);
    for (int k = 0; k < 3; ++k) {
      if (t.next[k] == Delaunay::kNone) continue;
      const Triangle& n = mesh.triangles()[t.next[k]];
      int j = 0;
      while (j < 3 && n.next[j] != i) ++j;
      ASSERT_LT(j, 3);
      EXPECT_EQ(n.v[(j + 1) % 3], t.v[(k + 2) % 3]);
      EXPECT_EQ(n.v[(j + 2) % 3], t.v[(k + 1) % 3]);
      EXPECT_EQ((n.fixed >> j) & 1, (t.fixed >> k) & 1);
    }
  }
}

// The definition, point by point: none lies inside a triangle's circle and is seen from inside the
// triangle across its edges.
void expect_delaunay(const Delaunay& mesh, const std::vector<std::array<std::uint32_t, 2>>& lines) {
  const Points& p = mesh.points();
  for (const Triangle& t : mesh.triangles())
    for (std::uint32_t q = 0; q < p.size(); ++q) {
      if (q == t.v[0] || q == t.v[1] || q == t.v[2]) continue;
      if (in_circle(p[t.v[0]], p[t.v[1]], p[t.v[2]], p[q]) <= 0) continue;
      // Seen from the triangle's middle (in thirds of coordinates)?
      const glm::ivec2 middle = p[t.v[0]] + p[t.v[1]] + p[t.v[2]];
      bool hidden = false;
      for (const auto& [a, b] : lines)
        hidden = hidden || cross_properly(middle, 3 * p[q], 3 * p[a], 3 * p[b]) ||
                 orientation(middle, 3 * p[q], 3 * p[a]) == 0 ||
                 orientation(middle, 3 * p[q], 3 * p[b]) == 0;
      EXPECT_TRUE(hidden) << q;
    }
}

TEST(Delaunay, a_point_inside_the_circle_is_told_from_one_on_it_exactly) {
  const int s = 16384;
  EXPECT_EQ(in_circle({0, 0}, {s, 0}, {s, s}, {0, s}), 0);
  EXPECT_GT(in_circle({0, 0}, {s, 0}, {s, s}, {1, s}), 0);
  EXPECT_GT(in_circle({0, 0}, {s, 0}, {s, s}, {1, s - 1}), 0);
  EXPECT_LT(in_circle({1, 0}, {s, 0}, {s, s}, {0, s}), 0);
}

TEST(Delaunay, random_points_are_joined_as_the_definition_says) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    // On a coarse lattice nearly all circles hold four points, and many points repeat.
    const int size = seed % 3 == 0 ? 8 : seed % 3 == 1 ? 64 : Delaunay::kMaxSize;
    Delaunay mesh(size);
    std::set<std::pair<int, int>> places{{0, 0}, {size, 0}, {size, size}, {0, size}};
    for (int i = 0; i < 60; ++i) {
      const glm::ivec2 place{random.below(size + 1), random.below(size + 1)};
      const std::uint32_t point = mesh.insert(place, std::uint32_t(random.below(9)));
      EXPECT_EQ(mesh.points()[point], place);
      places.insert({place.x, place.y});
    }
    EXPECT_EQ(mesh.points().size(), places.size());
    EXPECT_EQ(total_area(mesh), 2 * std::int64_t(size) * size);
    expect_linked(mesh);
    expect_delaunay(mesh, {});
  }
}

TEST(Delaunay, constraints_become_edges_and_the_rest_stays_delaunay) {
  int accepted = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const int size = seed % 2 ? 12 : 4096;
    Delaunay mesh(size);
    for (int i = 0; i < 30; ++i) mesh.insert({random.below(size + 1), random.below(size + 1)});
    std::vector<std::array<std::uint32_t, 2>> lines;
    for (int i = 0; i < 12; ++i) {
      const auto pick = [&] { return std::uint32_t(random.below(int(mesh.points().size()))); };
      const std::uint32_t a = pick(), b = pick();
      if (a == b) continue;
      const bool crosses = std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
        return cross_properly(mesh.points()[a], mesh.points()[b], mesh.points()[line[0]],
                              mesh.points()[line[1]]);
      });
      // Lines may meet in a point that both pass through.
      const bool in_a_point = std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
        return std::any_of(mesh.points().begin(), mesh.points().end(), [&](const glm::ivec2& p) {
          return orientation(mesh.points()[a], mesh.points()[b], p) == 0 &&
                 orientation(mesh.points()[line[0]], mesh.points()[line[1]], p) == 0;
        });
      });
      if (crosses) {
        Delaunay copy = mesh;
        EXPECT_TRUE(in_a_point || !copy.constrain(a, b));
        ++refused;
        continue;
      }
      ASSERT_TRUE(mesh.constrain(a, b));
      lines.push_back({a, b});
      ++accepted;
    }
    // Points that come later respect them.
    for (int i = 0; i < 20; ++i) {
      const glm::ivec2 place{random.below(size + 1), random.below(size + 1)};
      const bool on_line = std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
        return orientation(mesh.points()[line[0]], mesh.points()[line[1]], place) == 0;
      });
      if (!on_line) mesh.insert(place);
    }
    EXPECT_EQ(total_area(mesh), 2 * std::int64_t(size) * size);
    expect_linked(mesh);
    expect_delaunay(mesh, lines);
    for (const auto& [a, b] : lines)
      for (const Triangle& t : mesh.triangles())
        for (int k = 0; k < 3; ++k)
          EXPECT_FALSE(cross_properly(mesh.points()[a], mesh.points()[b], mesh.points()[t.v[k]],
                                      mesh.points()[t.v[(k + 1) % 3]]));
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 20);
}

TEST(Delaunay, what_has_changed_is_told) {
  Delaunay mesh(100);
  mesh.clear_changed();
  mesh.insert({50, 40});
  EXPECT_EQ(mesh.changed().size(), 4u);
  std::vector<Triangle> before = mesh.triangles();
  mesh.clear_changed();
  mesh.insert({20, 90});
  before.resize(mesh.triangles().size());
  for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle& now = mesh.triangles()[t];
    const bool same = std::equal(now.v, now.v + 3, before[t].v);
    const bool told = std::count(mesh.changed().begin(), mesh.changed().end(), t) == 1;
    EXPECT_TRUE(same || told) << t;
  }
}

}  // namespace
}  // namespace rilievo

#include "rilievo/scene/polygons/polygon_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace rilievo {
namespace {

// A polygon around the origin whose radius jumps about: simple, and mostly not convex.
std::vector<glm::dvec2> random_star(std::mt19937& rng) {
  std::uniform_real_distribution<double> radius(0.2, 1.0);
  const int corners = 4 + int(rng() % 40);
  std::vector<glm::dvec2> star;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    star.push_back(radius(rng) * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return star;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

bool inside_triangle(const glm::dvec2& p, const std::array<glm::dvec2, 3>& t) {
  for (int k = 0; k < 3; ++k)
    if (cross(t[(k + 1) % 3] - t[k], p - t[k]) < 0) return false;
  return true;
}

// Even and odd crossings of a ray to the right.
bool inside_polygon(const glm::dvec2& p, const std::vector<glm::dvec2>& polygon) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y))
      inside = !inside;
  }
  return inside;
}

PolygonSoup cut(const std::vector<glm::vec3>& corners) {
  PolygonSoup soup;
  soup.positions.assign(corners.begin(), corners.end());
  std::vector<Corner> polygon;
  for (std::uint32_t i = 0; i < corners.size(); ++i) polygon.push_back({i});
  MemoryBudget budget(1 << 24);
  add_polygon(soup, polygon, 0, budget);
  return soup;
}

TEST(AddPolygon, triangles_tile_the_polygon) {
  std::mt19937 rng(71);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int round = 0; round < 300; ++round) {
    const std::vector<glm::dvec2> star = random_star(rng);
    // In a random plane, turned either way.
    const glm::dvec3 axis = glm::normalize(glm::dvec3(u(rng), u(rng), 1.5 + u(rng)));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0.3, 1, 0.1), axis));
    const glm::dvec3 up = glm::cross(axis, right), at(u(rng), u(rng), u(rng));
    std::vector<glm::vec3> corners;
    for (const glm::dvec2& p : star) corners.push_back(glm::vec3(at + p.x * right + p.y * up));
    const PolygonSoup soup = cut(corners);
    ASSERT_EQ(soup.parts.size(), star.size() - 2);

    std::vector<std::array<glm::dvec2, 3>> triangles;
    for (std::size_t t = 0; t < soup.parts.size(); ++t) {
      triangles.emplace_back();
      for (int k = 0; k < 3; ++k) triangles.back()[k] = star[soup.triangles[3 * t + k].position];
      const auto& [a, b, c] = triangles.back();
      // Slivers may be a rounding of floats inside out.
      EXPECT_GT(cross(b - a, c - a), -1e-6);
    }
    for (int sample = 0; sample < 100; ++sample) {
      const glm::dvec2 p(u(rng), u(rng));
      const auto covering = std::count_if(triangles.begin(), triangles.end(),
                                          [&](const auto& t) { return inside_triangle(p, t); });
      EXPECT_EQ(covering, inside_polygon(p, star) ? 1 : 0) << round;
    }
  }
}

// An outline's corners are whole numbers below 2^23, so that areas are exact. Triangles that all
// run as the outline does, and have its area together, tile it.
void expect_exact_tiling(const std::vector<glm::vec3>& outline) {
  const PolygonSoup soup = cut(outline);
  ASSERT_EQ(soup.parts.size(), outline.size() - 2);
  double area = 0, tiled = 0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    area += cross(glm::dvec2(outline[i]), glm::dvec2(outline[(i + 1) % outline.size()]));
  int turned = 0;
  for (std::size_t t = 0; t < soup.parts.size(); ++t) {
    const auto at = [&](std::size_t k) {
      return glm::dvec2(outline[soup.triangles[3 * t + k].position]);
    };
    const double each = cross(at(1) - at(0), at(2) - at(0));
    turned += each * area <= 0;
    tiled += each;
  }
  EXPECT_EQ(turned, 0);
  EXPECT_EQ(tiled, area);
  EXPECT_FALSE(soup.cut_short);
}

TEST(AddPolygon, thousands_of_corners_are_tiled_exactly) {
  std::mt19937 rng(75);
  std::uniform_real_distribution<double> u(0.2, 1);
  for (int round = 0; round < 4; ++round) {
    constexpr int kCorners = 4000;
    std::vector<glm::vec3> star, band, wall;
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2 * std::numbers::pi * i / kCorners, radius = u(rng) * (1 << 22);
      star.push_back(
          {std::round(radius * std::cos(angle)), std::round(radius * std::sin(angle)), 0});
    }
    // Above and below the axis.
    for (int i = 0; i < kCorners / 2; ++i) band.push_back({i, -1.0f - float(rng() % 100000), 0});
    for (int i = kCorners / 2; i-- > 0;) band.push_back({i, 1.0f + float(rng() % 100000), 0});
    // Battlements, whose edges have corners all along.
    for (int i = 0; i < kCorners; ++i) wall.push_back({i, i / 50 % 2 * 300 + i / 100 % 3, 0});
    for (int i = kCorners; i-- > 0;) wall.push_back({i, -1, 0});
    for (std::vector<glm::vec3>* outline : {&star, &band, &wall}) {
      if (round % 2)
        for (glm::vec3& p : *outline) p = {p.y, p.x, 0};
      if (round / 2) std::reverse(outline->begin(), outline->end());
      expect_exact_tiling(*outline);
    }
  }
}

TEST(AddPolygon, survives_what_is_not_simple) {
  std::mt19937 rng(72);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<glm::vec3> corners(3 + rng() % 30);
    for (glm::vec3& c : corners) c = {u(rng), u(rng), round % 2 ? 0 : u(rng)};
    for (std::size_t k = 0; k < corners.size() / 4; ++k)
      corners[rng() % corners.size()] = corners[rng() % corners.size()];
    EXPECT_LE(cut(corners).parts.size(), corners.size() - 2);
  }
  // A line, and a point.
  EXPECT_EQ(cut(std::vector<glm::vec3>(5, glm::vec3(1))).parts.size(), 3u);
}

TEST(AddPolygon, a_huge_polygon_takes_no_longer_than_it_must) {
  // A comb: if every corner were tested against all others, 10^13 tests.
  std::vector<glm::vec3> comb;
  for (int i = 0; i < 20000; ++i) comb.push_back({i, i % 2 ? 1.0f : 100.0f, 0});
  comb.push_back({20000, 0, 0});
  comb.push_back({0, 0, 0});
  expect_exact_tiling(comb);
}

// Corners at random cross themselves everywhere; where nearly all lie on a line, no look finds an
// ear.
TEST(AddPolygon, polygons_that_cross_themselves_share_what_work_is_allowed) {
  std::mt19937 rng(76);
  std::uniform_real_distribution<float> u(-1, 1);
  for (const bool line : {false, true}) {
    PolygonSoup soup;
    soup.work_left = 0;  // but what the corners add
    std::vector<Corner> polygon;
    for (std::uint32_t i = 0; i < 4000; ++i) {
      polygon.push_back({i});
      soup.positions.push_back({u(rng), line && i % 2000 ? 0 : u(rng), 0});
    }
    MemoryBudget budget(1 << 24);
    add_polygon(soup, polygon, 0, budget);
    EXPECT_EQ(soup.parts.size(), polygon.size() - 2);
    EXPECT_TRUE(soup.cut_short);
    EXPECT_LE(soup.work_left, 0);
    EXPECT_GT(soup.work_left, -100'000);  // it ends within the look that takes the last of it
    // A later one still has what its own corners add.
    soup.positions = {{0, 0, 0}, {2, 1, 0}, {4, 0, 0}, {2, 4, 0}};
    add_polygon(soup, std::span(polygon).first(4), 0, budget);
    const std::vector<Corner> last(soup.triangles.end() - 6, soup.triangles.end());
    const std::vector<Corner> expected = {{3}, {0}, {1}, {1}, {2}, {3}};
    EXPECT_EQ(last, expected);
    EXPECT_GT(soup.work_left, 0);
  }
}

// The slow twin: every corner against every triangle.
TEST(MissingNormals, are_the_mean_of_the_triangles_within_the_crease) {
  std::mt19937 rng(73);
  for (int round = 0; round < 60; ++round) {
    // Points of a small grid, so that triangles meet in many places, by repeated positions, too.
    PolygonSoup soup;
    for (int i = 0; i < 40; ++i)
      soup.positions.push_back({float(rng() % 3), float(rng() % 3), float(rng() % 3)});
    MemoryBudget budget(1 << 24);
    for (int t = 0; t < 30; ++t) {
      const std::array<Corner, 3> c{Corner{std::uint32_t(rng() % 40)},
                                    {std::uint32_t(rng() % 40)},
                                    {std::uint32_t(rng() % 40)}};
      add_polygon(soup, c, 0, budget);
    }
    const PolygonSoup before = soup;
    add_missing_normals(soup, budget);
    const auto area_normal = [&](std::size_t t) {
      const auto at = [&](int k) {
        return glm::dvec3(soup.positions[soup.triangles[3 * t + k].position]);
      };
      return glm::cross(at(1) - at(0), at(2) - at(0));
    };
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
      const glm::dvec3& here = soup.positions[soup.triangles[i].position];
      const glm::dvec3 own = area_normal(i / 3);
      if (glm::length(own) == 0) continue;
      glm::dvec3 sum(0);
      bool doubtful = false;
      for (std::size_t k = 0; k < soup.triangles.size(); ++k) {
        if (soup.positions[soup.triangles[k].position] != here) continue;
        const glm::dvec3 other = area_normal(k / 3);
        if (glm::length(other) == 0) continue;
        const double angle = std::acos(
            std::clamp(glm::dot(own, other) / glm::length(own) / glm::length(other), -1.0, 1.0));
        // On a grid many angles are 45 degrees to the last digit: either way is right.
        doubtful = doubtful || std::abs(angle - std::numbers::pi / 4) < 1e-6;
        if (angle < std::numbers::pi / 4) sum += other;
      }
      if (doubtful) continue;
      const glm::vec3 n = soup.normals[soup.triangles[i].normal];
      EXPECT_LT(glm::length(glm::dvec3(n) - glm::normalize(sum)), 1e-6);  // rounding to floats
    }
    EXPECT_EQ(before.positions, soup.positions);
  }
}

TEST(Weld, every_corner_keeps_what_it_referred_to) {
  std::mt19937 rng(74);
  for (int round = 0; round < 100; ++round) {
    PolygonSoup soup;
    for (int i = 0; i < 10; ++i) {
      soup.positions.push_back({float(i), float(rng() % 5), 0});
      soup.uv.push_back({float(i), 1});
      soup.normals.push_back({0, float(i), 1});
      soup.colors.push_back({float(i), 0, 0, 1});
    }
    for (int t = 0; t < 40; ++t) {
      for (int k = 0; k < 3; ++k)
        soup.triangles.push_back(
            {std::uint32_t(rng() % 10), std::uint32_t(rng() % 3), std::uint32_t(rng() % 3)});
      soup.parts.push_back(rng() % 2);
    }
    MemoryBudget budget(1 << 24);
    const std::vector<Mesh> meshes = weld(soup, 2, budget);
    std::size_t next[2] = {0, 0};
    std::vector<Corner> distinct[2];
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
      const Corner& c = soup.triangles[i];
      const std::uint32_t part = soup.parts[i / 3];
      const Mesh& mesh = meshes[part];
      const std::uint32_t v = mesh.indices[next[part]++];
      EXPECT_EQ(mesh.positions[v], soup.place(c.position));
      EXPECT_EQ(mesh.uv[0][v], soup.uv[c.uv]);
      EXPECT_EQ(mesh.normals[v], soup.normals[c.normal]);
      EXPECT_EQ(mesh.colors[v], soup.colors[c.position]);
      if (std::find(distinct[part].begin(), distinct[part].end(), c) == distinct[part].end())
        distinct[part].push_back(c);
    }
    for (int part = 0; part < 2; ++part) {
      EXPECT_EQ(next[part], meshes[part].indices.size());
      EXPECT_EQ(meshes[part].positions.size(), distinct[part].size());
    }
  }
}

}  // namespace
}  // namespace rilievo

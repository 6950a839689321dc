#include "rilievo/environment_nodes/silhouettes.h"

#include <gtest/gtest.h>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/delaunay.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

// Balls in front of a wall, of all sizes down to single texels, and noise for the smallest.
EnvironmentMap crowded_node(int size, std::uint64_t seed) {
  Random random(seed);
  std::vector<DistanceAlong> all{box_around({-9, -9, -9}, {9, 9, 9})};
  for (int i = 0; i < 60; ++i) {
    const auto place = [&] { return double(random.between(-1, 1)); };
    const glm::dvec3 to(place(), place(), place());
    all.push_back(ball(double(random.between(2, 6)) * glm::normalize(to + 1e-3),
                       double(random.between(0.02f, 0.9f))));
  }
  return make_node(size, nearest_of(all));
}

TEST(CubeGrid, neighbours_across_an_edge_know_each_other) {
  const EnvironmentMap map = make_node(8, box_around({-1, -2, -3}, {3, 2, 1}));
  const CubeGrid grid(map, {});
  for (int f = 0; f < 6; ++f)
    for (int side = 0; side < 4; ++side)
      for (int k = 0; k < 8; ++k) {
        const SideTexel a{f, side, k}, b = grid.across(a), back = grid.across(b);
        EXPECT_EQ(back.face, f);
        EXPECT_EQ(back.side, side);
        EXPECT_EQ(back.along, k);
        // The centres are as near to each other as those of texels in a face: on the cube, one
        // half texel away from the edge each, around the corner.
        const glm::ivec3 to = grid.key(b.face, 2 * grid.side_texel(b.side, b.along) + 1) -
                              grid.key(f, 2 * grid.side_texel(side, k) + 1);
        EXPECT_EQ(to.x * to.x + to.y * to.y + to.z * to.z, 2);
        EXPECT_EQ(grid.cut_border(a), grid.cut_border(b));
        EXPECT_EQ(grid.half(f, grid.key(f, {2 * k + 1, 3})), glm::ivec2(2 * k + 1, 3));
      }
}

TEST(CubeGrid, a_box_has_no_jumps_and_is_continued_exactly) {
  // From near one wall, along which one looks at 2 degrees.
  const EnvironmentMap map = make_node(64, box_around({-30, -0.9, -40}, {35, 2, 4}));
  const CubeGrid grid(map, {});
  for (int f = 0; f < 6; ++f)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        EXPECT_FALSE(x < 63 && grid.cut_right(f, x, y));
        EXPECT_FALSE(y < 63 && grid.cut_below(f, x, y));
      }
  // The middle of the floor, seen from above: disparity 1 / 0.9 all over.
  EXPECT_NEAR(grid.continued(3, {20, 30}, {40, 60}), 1 / 0.9f, 1e-5f);
  // The face towards -z, whose pictures stand on their heads: its lower half shows the ceiling, 2 m
  // up, 56 / 64 of a metre above the axis at a depth of one.
  EXPECT_NEAR(grid.continued(5, {32, 60}, {64, 120}), 56 / 64.0 / 2, 1e-4);
}

TEST(Silhouettes, every_texel_is_on_its_own_side) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const int n = 24;
    const EnvironmentMap map = crowded_node(n, seed);
    const CubeGrid grid(map, {});
    std::size_t cuts = 0, vertices = 0;
    for (int f = 0; f < 6; ++f) {
      const std::vector<Silhouette> all = trace_silhouettes(grid, f);
      std::vector<std::array<glm::ivec2, 2>> lines;
      for (const Silhouette& s : all) {
        EXPECT_EQ(s.line.front(), 2 * s.corners.front());
        EXPECT_EQ(s.line.back(), 2 * s.corners.back());
        vertices += s.line.size();
        for (std::size_t i = 1; i < s.line.size(); ++i) lines.push_back({s.line[i - 1], s.line[i]});
      }
      const auto crossings = [&](const glm::ivec2& a, const glm::ivec2& b) {
        int count = 0;
        for (const auto& line : lines) {
          // A vertex may be the middle of the gate: the line and the next one touch there.
          if (line[1] == (a + b) / 2)
            ++count;
          else if (line[0] != (a + b) / 2 && cross_properly(line[0], line[1], a, b))
            ++count;
        }
        return count;
      };
      for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
          const glm::ivec2 here{2 * x + 1, 2 * y + 1};
          if (x + 1 < n) {
            EXPECT_EQ(crossings(here, here + glm::ivec2(2, 0)), int(grid.cut_right(f, x, y)));
            cuts += grid.cut_right(f, x, y);
          }
          if (y + 1 < n) {
            EXPECT_EQ(crossings(here, here + glm::ivec2(0, 2)), int(grid.cut_below(f, x, y)));
            cuts += grid.cut_below(f, x, y);
          }
        }
      for (const auto& a : lines)
        for (const auto& b : lines) EXPECT_FALSE(cross_properly(a[0], a[1], b[0], b[1]));
    }
    EXPECT_GT(cuts, 500u);
    EXPECT_LT(vertices, cuts);
  }
}

// The slow way: no line crosses the segment between the two texels' centres.
TEST(Silhouettes, texels_of_one_surface_that_meet_at_a_corner_alone_are_joined) {
  int joined = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const int n = 24;
    const CubeGrid grid(crowded_node(n, seed), {});
    for (int f = 0; f < 6; ++f) {
      const std::vector<Silhouette> all = trace_silhouettes(grid, f);
      for (int y = 1; y < n; ++y)
        for (int x = 1; x < n; ++x) {
          const CubeGrid::Diagonal diagonal = grid.joined_diagonal(f, {x, y});
          if (diagonal == CubeGrid::Diagonal::none) continue;
          const glm::ivec2 corner{2 * x, 2 * y};
          const glm::ivec2 half(1, diagonal == CubeGrid::Diagonal::down_right ? 1 : -1);
          const glm::ivec2 other(half.x, -half.y);
          ++joined;
          const auto at = [&](const glm::ivec2& centre) { return grid.at(f, (centre - 1) / 2); };
          for (const glm::ivec2& near : {corner - half, corner + half})
            for (const glm::ivec2& far : {corner - other, corner + other})
              EXPECT_GT(at(near), at(far));
          for (const Silhouette& s : all)
            for (std::size_t i = 1; i < s.line.size(); ++i) {
              // But for a line that can begin nowhere else.
              if (s.line.front() == corner && s.line.back() == corner) continue;
              EXPECT_FALSE(cross_properly(s.line[i - 1], s.line[i], corner - half, corner + half));
              EXPECT_NE(s.line[i], corner);
            }
        }
    }
  }
  EXPECT_GT(joined, 20);
}

TEST(Silhouettes, a_straight_edge_is_two_vertices_whatever_its_slope) {
  for (const int slope : {1, 2, 3, 4}) {
    // Between the centres of column x the line y = (x + 1/2) / slope passes; moved for odd slopes,
    // so that it comes no nearer to any centre than the polyline may.
    const auto height = [&](int x) {
      const int twice = 2 * x + (slope % 2 ? 2 : 1);  // / (2 slope), to be rounded
      return (twice + slope) / (2 * slope);
    };
    std::vector<glm::ivec2> corners{{0, height(0)}};
    for (int x = 0; x < 60; ++x) {
      while (corners.back().y < height(x)) corners.push_back(corners.back() + glm::ivec2(0, 1));
      corners.push_back({x + 1, corners.back().y});
    }
    // The ends are texels' corners, where the line itself need not pass.
    EXPECT_LE(straightened(corners).size(), 5u) << slope;
  }
}

}  // namespace
}  // namespace rilievo

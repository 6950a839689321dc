#include "rilievo/environment_nodes/texel_weights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

TEST(TexelWeights, are_the_cosines_of_flat_walls_far_from_silhouettes) {
  // A room: nothing hides anything, and each face sees several walls.
  const int n = 32;
  const EnvironmentMap map = make_node(n, box_around({-2, -1, -3}, {4, 2.5, 5}));
  const auto weights = texel_weights(CubeGrid(map, {}));
  int checked = 0;
  for (std::size_t f = 0; f < 6; ++f)
    for (int y = 1; y < n - 1; ++y)
      for (int x = 1; x < n - 1; ++x) {
        const DepthImage& face = map.faces[f];
        const auto point = [&](int i, int j) {
          return world_from_raster(face.camera, {i + 0.5, j + 0.5}, double(face.depth(i, j)));
        };
        // Of one wall with its neighbours.
        const glm::dvec3 low(-2, -1, -3), high(4, 2.5, 5), p = point(x, y);
        int wall = -1, walls = 0;
        for (int axis = 0; axis < 3; ++axis)
          for (const glm::dvec3& side : {low, high})
            if (std::abs(p[axis] - side[axis]) < 1e-4) wall = axis, ++walls;
        bool alone = walls == 1;
        for (const auto& [i, j] : {std::pair(x - 1, y), {x + 1, y}, {x, y - 1}, {x, y + 1}})
          alone = alone && std::abs(point(i, j)[wall] - p[wall]) < 1e-4;
        if (!alone) continue;
        const double cosine = std::abs(p[wall]) / glm::length(p);
        // Depths are floats; a step is 1/255.
        EXPECT_NEAR(weights[f](x, y), 255 * cosine, 1.0) << f << " " << x << " " << y;
        ++checked;
      }
  EXPECT_GT(checked, 3000);
}

TEST(TexelWeights, rise_from_nothing_at_silhouettes_over_the_edges_of_faces_too) {
  // A ball in a sphere of sky: all is seen about head on, but at the ball's rim. It lies on the
  // edge between two faces.
  const int n = 48;
  const EnvironmentMap map = make_node(n, ball({2, 0.1, -2}, 0.8));
  const CubeGrid grid(map, {});
  const auto weights = texel_weights(grid);
  int zero = 0, full = 0;
  for (int f = 0; f < 6; ++f)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        if (grid.at(f, {x, y}) > 0) continue;
        // Steps to the nearest texel of the ball on this face, and whether one is anywhere near.
        int steps = 1000;
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i)
            if (grid.at(f, {i, j}) > 0) steps = std::min(steps, std::abs(i - x) + std::abs(j - y));
        const int weight = weights[std::size_t(f)](x, y);
        if (steps <= kFeather) {
          // From beyond the edge a silhouette may be nearer still.
          EXPECT_LE(weight, std::lround(255.0 * (steps - 1) / kFeather));
          if (std::min(x, n - 1 - x) > kFeather) {
            EXPECT_EQ(weight, std::lround(255.0 * (steps - 1) / kFeather));
          }
        }
        zero += weight == 0, full += weight == 255;
        const int aside = std::min({x, y, n - 1 - x, n - 1 - y});
        if (steps > kFeather && aside > kFeather) {
          EXPECT_EQ(weight, 255);
        }
        // The sky beside the ball, seen on the next face.
        const glm::dvec3 to =
            world_from_raster(map.faces[std::size_t(f)].camera, {x + 0.5, y + 0.5}, 1.0);
        const double angle =
            std::acos(glm::dot(glm::normalize(to), glm::normalize(glm::dvec3(2, 0.1, -2))));
        const double rim = std::asin(0.8 / glm::length(glm::dvec3(2, 0.1, -2)));
        if (angle < rim + 1.0 / n) {
          EXPECT_LE(weight, 255 * 3 / kFeather);
        }
      }
  EXPECT_GT(zero, 50);
  EXPECT_GT(full, 5 * n * n - 2000);
}

}  // namespace
}  // namespace rilievo

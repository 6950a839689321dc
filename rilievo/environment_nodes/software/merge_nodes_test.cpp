// What the eye sees where nodes are merged: no second outlines, nothing that another node knows not
// to be there, no sheets of sky.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "rilievo/core/color.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/environment_nodes/software/node_tiles.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

constexpr int kMergedWidth = 64, kMergedHeight = 48;

class MergeNodesTest : public testing::Test {
 protected:
  void keep(std::size_t number, const EnvironmentMap& map) {
    tiles_.keep(number, map, triangulate(map, {}));
  }
  // How many pixels of the frame are magenta, more or less.
  [[nodiscard]] int count_magenta(const glm::dvec3& eye, const glm::dvec3& target,
                                  std::size_t nodes, NodeMerge merge) {
    const Camera frame =
        look_at(eye, target, {0, 1, 0}, 1.0, kMergedWidth, kMergedHeight, 0.05, 40);
    auto tile = std::make_unique<FrameTile>();
    tile->width = frame.width, tile->height = frame.height, tile->samples = 1;
    tile->of = TileContent::color;
    tile->nothing = float(1 / frame.z_far);
    tile->clear(0);
    const std::size_t all[] = {0, 1};
    tiles_.set_samples(1);
    tiles_.begin();
    tiles_.draw(frame, 1.0, {all, nodes}, Output::color, kNoObject, {merge, true});
    tiles_.draw_tile(*tile);
    int count = 0;
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        const TilePixel at(*tile, x, y);
        const std::uint32_t c = tile->first[at.block].content[at.pixel];
        count += (c & 0xff) > 120 && (c >> 8 & 0xff) < 90 && (c >> 16 & 0xff) > 120;
      }
    return count;
  }

  NodeTiles tiles_;
};

const glm::vec4 kMagenta(1, 0, 1, 1), kGreen(0, 0.5f, 0, 1);

// A ball before a wall, from two places; the wall beside the ball's silhouette has the ball's
// colour mixed in, as where texels are the mean of several samples.
TEST_F(MergeNodesTest, what_is_mixed_at_a_silhouette_does_not_stay_on_the_wall) {
  const glm::dvec3 eyes[] = {{-0.8, 0, 0}, {0.8, 0, 0}};
  for (std::size_t k = 0; k < 2; ++k) {
    const DistanceAlong front = ball(glm::dvec3(0, 0, -1.5) - eyes[k], 0.3);
    const DistanceAlong wall =
        box_around(glm::dvec3(-4, -2, -4) - eyes[k], glm::dvec3(4, 2, 4) - eyes[k]);
    const DistanceAlong halo = ball(glm::dvec3(0, 0, -1.5) - eyes[k], 0.33);
    keep(k, make_node(
                64, nearest_of({front, wall}),
                [&](const glm::dvec3& d, double) {
                  if (std::isfinite(front(d))) return glm::vec4(0.2f, 0.2f, 0.2f, 1);
                  return std::isfinite(halo(d)) ? kMagenta : kGreen;
                },
                eyes[k]));
  }
  // From between them each one's halo lies on a part of the wall that the other one sees well. What
  // is left is on the ball's own rim, between its texels and those beside it.
  const glm::dvec3 eye(0.05, 0.1, 0.1), target(0.05, 0, -4);
  const int alone = count_magenta(eye, target, 1, NodeMerge::positional);
  EXPECT_GT(alone, 20);
  for (const NodeMerge merge : {NodeMerge::binary, NodeMerge::weighted, NodeMerge::positional})
    EXPECT_LT(3 * count_magenta(eye, target, 2, merge), alone) << int(merge);
}

// The second node shows a plate in the air that the first one looks through.
TEST_F(MergeNodesTest, what_another_node_sees_through_is_not_there) {
  const glm::dvec3 eyes[] = {{0, 0, 0.5}, {1.2, 0, 0.5}};
  for (std::size_t k = 0; k < 2; ++k) {
    const glm::dvec3 e = eyes[k];
    const DistanceAlong plate = [e](const glm::dvec3& d) {
      const double t = (-2 - e.z) / d.z;
      const glm::dvec3 at = e + t * d;
      return t > 0 && std::abs(at.x) < 0.6 && std::abs(at.y) < 0.5 ? t : INFINITY;
    };
    const DistanceAlong room = box_around(glm::dvec3(-4, -2, -4) - e, glm::dvec3(4, 2, 4) - e);
    keep(k, make_node(
                64, k == 0 ? room : nearest_of({plate, room}),
                [&](const glm::dvec3& d, double) {
                  return k == 1 && std::isfinite(plate(d)) ? kMagenta : kGreen;
                },
                e));
  }
  for (const NodeMerge merge : {NodeMerge::binary, NodeMerge::weighted, NodeMerge::positional})
    EXPECT_EQ(count_magenta({0.1, 0.05, 0.4}, {0.1, 0, -4}, 2, merge), 0) << int(merge);
}

// A wall before the sky, of the sky's colour nothing stands behind it.
TEST_F(MergeNodesTest, no_sheet_of_sky_stands_on_a_wall) {
  const DistanceAlong wall = [](const glm::dvec3& d) {
    const double t = -2 / d.z;
    return d.z < 0 && t * d.y < -0.5 && t * d.y > -1.5 && std::abs(t * d.x) < 1.5 ? t : INFINITY;
  };
  const EnvironmentMap map = make_node(64, wall, [&](const glm::dvec3& d, double) {
    return std::isfinite(wall(d)) ? kGreen : kMagenta;
  });
  const NodeMesh mesh = triangulate(map, {});
  for (std::size_t t = mesh.surface_triangles(); t < mesh.triangles(); ++t)
    for (int k = 0; k < 3; ++k)
      EXPECT_GT(mesh.vertices[mesh.indices[3 * t + std::size_t(k)]].disparity, 0);
}

}  // namespace
}  // namespace rilievo

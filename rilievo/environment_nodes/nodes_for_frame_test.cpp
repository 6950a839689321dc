#include "rilievo/environment_nodes/nodes_for_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

// A hall with columns and walls in it.
struct Hall {
  glm::dvec3 low{-8, -1.5, -5}, high{8, 2, 5};
  std::vector<Box> blocks;

  // In lengths of `d`.
  [[nodiscard]] double first_hit(const glm::dvec3& from, const glm::dvec3& d) const {
    double nearest = INFINITY;
    for (int k = 0; k < 3; ++k)
      if (d[k] != 0) nearest = std::min(nearest, ((d[k] > 0 ? high[k] : low[k]) - from[k]) / d[k]);
    for (const Box& block : blocks) {
      double enter = 0, leave = INFINITY;
      for (int k = 0; k < 3; ++k) {
        const double a = (double(block.min[k]) - from[k]) / d[k],
                     b = (double(block.max[k]) - from[k]) / d[k];
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
      }
      if (enter > 0 && enter < leave) nearest = std::min(nearest, enter);
    }
    return nearest;
  }
  [[nodiscard]] bool is_free(const glm::dvec3& at, double clearance) const {
    return std::none_of(blocks.begin(), blocks.end(), [&](const Box& block) {
      return glm::all(glm::greaterThan(at, glm::dvec3(block.min) - clearance)) &&
             glm::all(glm::lessThan(at, glm::dvec3(block.max) + clearance));
    });
  }
  [[nodiscard]] glm::dvec3 free_place(Random& random) const {
    while (true) {
      const glm::dvec3 at(double(random.between(-7.5f, 7.5f)), double(random.between(-0.5f, 1.0f)),
                          double(random.between(-4.5f, 4.5f)));
      if (is_free(at, 0.2)) return at;
    }
  }
};

Hall random_hall(Random& random, int blocks) {
  Hall hall;
  for (int i = 0; i < blocks; ++i) {
    const glm::vec3 at(random.between(-7, 7), 0, random.between(-4, 4));
    const float wide = random.between(0.2f, 2.0f), deep = random.between(0.2f, 0.6f);
    Box block;
    block.add(at - glm::vec3(wide, 3, deep));
    block.add(at + glm::vec3(wide, 3, deep));
    hall.blocks.push_back(block);
  }
  return hall;
}

EnvironmentNodes nodes_in(const Hall& hall, const std::vector<glm::dvec3>& eyes) {
  std::vector<DepthImage> pictures;
  for (const glm::dvec3& eye : eyes) {
    const EnvironmentMap map = make_node(
        96, [&](const glm::dvec3& d) { return hall.first_hit(eye, d); }, nullptr, eye);
    pictures.insert(pictures.end(), map.faces.begin(), map.faces.end());
  }
  Result<EnvironmentNodes> nodes = make_environment_nodes(std::move(pictures), {});
  EXPECT_TRUE(nodes.ok()) << nodes.error().message();
  return std::move(*nodes);
}

Camera random_frame(const Hall& hall, Random& random) {
  const glm::dvec3 eye = hall.free_place(random);
  const double turn = double(random.between(0, 6.28f));
  return look_at(
      eye, eye + glm::dvec3(std::cos(turn), double(random.between(-0.3f, 0.3f)), std::sin(turn)),
      {0, 1, 0}, 1.0, 64, 36, 0.05, 100);
}

// The slow way: rays into the scene, from the eye, and from each node to what the eye sees.
std::vector<SeenPlace> true_places(const Hall& hall, const EnvironmentNodes& nodes,
                                   const Camera& frame, const std::vector<std::size_t>& order) {
  std::vector<SeenPlace> places;
  for (int row = 0; row < kViewRows; ++row)
    for (int column = 0; column < kViewColumns; ++column) {
      const glm::dvec2 raster((column + 0.5) / kViewColumns * frame.width,
                              (1 - (row + 0.5) / kViewRows) * frame.height);
      const glm::dvec3 along =
          glm::normalize(world_from_raster(frame, raster, 1) - frame.position());
      SeenPlace place{hall.first_hit(frame.position(), along), 0};
      const glm::dvec3 at = frame.position() + 0.9999 * place.distance * along;
      for (std::size_t k = 0; k < order.size(); ++k) {
        const glm::dvec3 node = nodes.nodes[order[k]].eye();
        if (hall.first_hit(node, at - node) >= 1) place.held |= 1u << k;
      }
      places.push_back(place);
    }
  return places;
}

TEST(NodesForFrame, what_the_eye_sees_and_which_nodes_hold_it_is_found_as_rays_find_it) {
  Random random(1);
  int asked = 0, wrong = 0, lacking = 0, off = 0;
  for (int scene = 0; scene < 6; ++scene) {
    const Hall hall = random_hall(random, 8);
    std::vector<glm::dvec3> eyes;
    for (int i = 0; i < 8; ++i) eyes.push_back(hall.free_place(random));
    const EnvironmentNodes nodes = nodes_in(hall, eyes);
    for (int f = 0; f < 6; ++f) {
      const Camera frame = random_frame(hall, random);
      const std::vector<std::size_t> order = nodes_for_eye(nodes, frame.position());
      const std::vector<SeenPlace> found = places_in_view(nodes, frame, order, 2),
                                   truth = true_places(hall, nodes, frame, order);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        if (truth[i].held == 0) continue;  // no node knows of it
        ++asked;
        const bool two = (found[i].held & 3) != 0;
        wrong += two != ((truth[i].held & 3) != 0);
        if (two) continue;
        ++lacking;
        off += std::abs(found[i].distance - truth[i].distance) > 0.05 * truth[i].distance ||
               std::popcount(found[i].held ^ truth[i].held) > 1;
      }
    }
  }
  EXPECT_GT(asked, 10000);
  EXPECT_GT(lacking, 1000);
  // Faces of 96 texels err beside silhouettes: 1.4 % of the view. Of what two nodes lack, most of
  // which lies beside silhouettes, a quarter is placed off, or two nodes are wrongly said to hold
  // it or not.
  EXPECT_LT(wrong, asked / 50);
  EXPECT_LT(off, lacking / 3);
}

TEST(NodesForFrame,
     a_third_node_is_shown_where_two_lack_something_and_it_is_the_one_that_holds_most) {
  Random random(2);
  int lacking = 0, whole = 0, needless = 0, poor = 0, missed = 0;
  for (int scene = 0; scene < 36; ++scene) {
    const Hall hall = random_hall(random, scene % 3 == 0 ? 0 : 8);
    std::vector<glm::dvec3> eyes;
    for (int i = 0; i < 8; ++i) eyes.push_back(hall.free_place(random));
    const EnvironmentNodes nodes = nodes_in(hall, eyes);
    for (int f = 0; f < 8; ++f) {
      const Camera frame = random_frame(hall, random);
      const FrameNodes chosen = nodes_for_frame(nodes, frame, 2, true);
      const std::vector<std::size_t> order = nodes_for_eye(nodes, frame.position());
      EXPECT_EQ(chosen.order[0], order[0]);
      EXPECT_EQ(chosen.order[1], order[1]);
      EXPECT_TRUE(std::is_permutation(order.begin(), order.end(), chosen.order.begin()));
      const std::vector<SeenPlace> truth = true_places(hall, nodes, frame, order);
      std::vector<int> adds(order.size());
      for (const SeenPlace& place : truth)
        for (std::size_t k = 2; k < order.size(); ++k)
          adds[k] += (place.held & 3) == 0 && (place.held >> k & 1) &&
                     sees(nodes.nodes[order[k]], frame.position());
      const int most = *std::max_element(adds.begin(), adds.end());
      if (most == 0) {
        ++whole;
        needless += chosen.drawn != 2;
      } else if (most > int(truth.size()) / 50) {
        ++lacking;
        missed += chosen.drawn != 3;
        const auto at = std::find(order.begin(), order.end(), chosen.order[2]) - order.begin();
        poor += adds[std::size_t(at)] < 0.8 * most;
      }
    }
  }
  EXPECT_GT(lacking, 10);
  EXPECT_GT(whole, 10);
  // A few, by those errors; the one that is chosen mostly holds nearly as much as the best. Scenes
  // depend on the compiler, which orders the random numbers of an expression: of 29 and 47 frames
  // that lack something 4 and 3 got a poor node, and 1 and 0 none.
  EXPECT_LE(needless, whole / 10);
  EXPECT_LE(poor, lacking / 6);
  EXPECT_LE(missed, lacking / 20);
}

// The slow way: all lines of sight are asked, then those are kept that are connected with one that
// is asked in any case: every fourth, and of the chessboard's others those between different
// depths.
TEST(NodesForFrame, a_third_node_is_there_for_what_is_connected_with_some_of_the_lines) {
  Random random(3);
  int compared = 0, lacking = 0, beside = 0;
  for (int scene = 0; scene < 12; ++scene) {
    const Hall hall = random_hall(random, 8);
    std::vector<glm::dvec3> eyes;
    for (int i = 0; i < 8; ++i) eyes.push_back(hall.free_place(random));
    const EnvironmentNodes nodes = nodes_in(hall, eyes);
    for (int f = 0; f < 8; ++f) {
      const Camera frame = random_frame(hall, random);
      const std::vector<std::size_t> order = nodes_for_eye(nodes, frame.position());
      const std::vector<SeenPlace> all = places_in_view(nodes, frame, order, 2);
      const auto lacks = [&](int column, int row) {
        const std::uint32_t held = all[FrameParts::number(column, row)].held;
        return held != 0 && (held & 3) == 0;
      };
      const auto is_rough = [&](int column, int row) {
        std::vector<double> depths;
        for (int y = row - 1; y <= std::min(row + 1, kViewRows - 1); y += 2)
          for (int x = column - 1; x <= std::min(column + 1, kViewColumns - 1); x += 2)
            depths.push_back(all[FrameParts::number(x, y)].distance);
        std::sort(depths.begin(), depths.end());
        return depths.back() > 1.3 * depths.front();
      };
      FrameParts reached;
      for (bool grows = true; grows;) {
        grows = false;
        for (int row = 0; row < kViewRows; ++row)
          for (int column = 0; column < kViewColumns; ++column) {
            if (!lacks(column, row) || reached.holds(column, row)) continue;
            bool found = column % 2 == row % 2 && (row % 2 == 0 || is_rough(column, row));
            for (int y = std::max(row - 1, 0); y <= std::min(row + 1, kViewRows - 1); ++y)
              for (int x = std::max(column - 1, 0); x <= std::min(column + 1, kViewColumns - 1);
                   ++x)
                found = found || reached.holds(x, y);
            if (found) grows = true, reached.marked.set(FrameParts::number(column, row));
          }
      }
      const FrameNodes chosen = nodes_for_frame(nodes, frame, 2, true);
      if (chosen.drawn != 3) continue;
      ++compared;
      const auto k = std::find(order.begin(), order.end(), chosen.order[2]) - order.begin();
      int in_some = 0;
      FrameParts from_all, from_some;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const bool fills = (all[i].held & 3) == 0 && (all[i].held >> k & 1) != 0;
        from_all.marked[i] = fills, from_some.marked[i] = fills && reached.marked[i];
        lacking += fills, beside += fills && !reached.marked[i];
        in_some += fills && reached.marked[i];
      }
      // Where few are found, all are asked.
      EXPECT_TRUE(chosen.filled.marked == from_some.marked ||
                  (in_some < 16 && chosen.filled.marked == from_all.marked));
    }
  }
  EXPECT_GT(compared, 10);
  EXPECT_GT(lacking, 500);
  // Specks of a line of sight.
  EXPECT_LT(beside, lacking / 20);
}

}  // namespace
}  // namespace rilievo

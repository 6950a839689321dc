#include "rilievo/capture/view_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;

int nearest_by_angle(const ViewSet& set, const glm::dvec3& direction) {
  int best = 0;
  for (int i = 0; i < int(set.directions.size()); ++i)
    if (std::acos(std::clamp(glm::dot(direction, set.directions[i]), -1.0, 1.0)) <
        std::acos(std::clamp(glm::dot(direction, set.directions[best]), -1.0, 1.0)))
      best = i;
  return best;
}

// Does the spherical triangle hold the direction? Solved as a linear system.
bool holds(const ViewSet& set, const std::array<int, 3>& t, const glm::dvec3& direction,
           double slack) {
  const glm::dmat3 m(set.directions[t[0]], set.directions[t[1]], set.directions[t[2]]);
  const glm::dvec3 w = glm::inverse(m) * direction;
  return std::min({w.x, w.y, w.z}) >= -slack;
}

ViewSet whole(ViewSpread spread) { return make_view_set({.spread = spread}); }

TEST(ViewSet, platonic_counts_and_even_spread) {
  const std::map<ViewSpread, std::size_t> counts{
      {ViewSpread::faces_12, 12}, {ViewSpread::vertices_20, 20}, {ViewSpread::both_32, 32}};
  for (const auto& [spread, count] : counts) {
    const ViewSet set = whole(spread);
    ASSERT_EQ(set.directions.size(), count);
    // Euler: a triangulated sphere of n points has 2 n - 4 triangles and 3 n - 6 edges.
    EXPECT_EQ(set.triangles.size(), 2 * count - 4);
    EXPECT_EQ(set.edges.size(), 3 * count - 6);
    double narrowest = 10;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(glm::length(set.directions[i]), 1.0, 1e-15);
      for (std::size_t k = 0; k < i; ++k)
        narrowest = std::min(narrowest, std::acos(glm::dot(set.directions[i], set.directions[k])));
    }
    // The angles between neighbours of the icosahedron, the dodecahedron, and between a face's
    // normal and its corners (63.43, 41.81 and 37.38 degrees).
    const double expected = count == 12   ? std::atan(2.0)
                            : count == 20 ? std::acos(std::sqrt(5.0) / 3)
                                          : std::acos(std::sqrt((5 + 2 * std::sqrt(5.0)) / 15));
    EXPECT_NEAR(narrowest, expected, 1e-12);
  }
}

TEST(ViewSet, triangles_cover_the_sphere_once) {
  std::mt19937 rng(1);
  for (ViewSpread spread : {ViewSpread::faces_12, ViewSpread::vertices_20, ViewSpread::both_32}) {
    const ViewSet set = whole(spread);
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 direction = random_direction(rng);
      int held = 0;
      for (const auto& t : set.triangles) held += holds(set, t, direction, 0.0);
      // On an edge two hold it; a random direction never lies on one.
      EXPECT_EQ(held, 1);
    }
  }
}

TEST(ViewSet, pick_is_the_nearest_view_and_the_triangle_around_the_direction) {
  std::mt19937 rng(2);
  for (ViewSpread spread : {ViewSpread::faces_12, ViewSpread::vertices_20, ViewSpread::both_32}) {
    const ViewSet set = whole(spread);
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 direction = random_direction(rng);
      const ViewPick pick = pick_views(set, direction * 7.0);
      EXPECT_EQ(pick.views[0], nearest_by_angle(set, direction));
      EXPECT_NEAR(pick.weights[0] + pick.weights[1] + pick.weights[2], 1.0, 1e-12);
      std::array<int, 3> picked = pick.views;
      std::sort(picked.begin(), picked.end());
      bool is_triangle = false, is_holder = false;
      for (const auto& t : set.triangles) {
        std::array<int, 3> sorted = t;
        std::sort(sorted.begin(), sorted.end());
        if (sorted != picked) continue;
        is_triangle = true;
        is_holder = holds(set, t, direction, 1e-12);
      }
      EXPECT_TRUE(is_triangle);
      // A pentagon's fan has obtuse triangles: there the nearest view may not be a corner of the
      // triangle that holds the direction.
      if (spread != ViewSpread::vertices_20) {
        EXPECT_TRUE(is_holder);
        glm::dvec3 again(0.0);
        for (int k = 0; k < 3; ++k) again += pick.weights[k] * set.directions[pick.views[k]];
        EXPECT_LT(glm::length(glm::normalize(again) - direction), 1e-9);
      }
    }
  }
}

TEST(ViewSet, at_a_view_that_view_alone) {
  const ViewSet set = whole(ViewSpread::both_32);
  for (int i = 0; i < 32; ++i) {
    const ViewPick pick = pick_views(set, set.directions[i]);
    EXPECT_EQ(pick.views[0], i);
    EXPECT_NEAR(pick.weights[0], 1.0, 1e-12);
  }
}

TEST(ViewSet, nearest_views_are_those_that_sorting_puts_first) {
  std::mt19937 rng(6);
  const ViewSet set = whole(ViewSpread::both_32);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 direction = random_direction(rng);
    std::vector<int> sorted(32);
    for (int k = 0; k < 32; ++k) sorted[k] = k;
    std::sort(sorted.begin(), sorted.end(), [&](int a, int b) {
      return glm::dot(direction, set.directions[a]) > glm::dot(direction, set.directions[b]);
    });
    for (int count : {1, 3, 6, 40}) {
      std::vector<int> views(count, -1);
      const int found = nearest_views(set, 3.0 * direction, views);
      ASSERT_EQ(found, std::min(count, 32));
      for (int k = 0; k < found; ++k) EXPECT_EQ(views[k], sorted[k]);
    }
  }
}

TEST(ViewSet, handover_is_continuous_and_sums_to_one) {
  std::mt19937 rng(7);
  for (ViewSpread spread : {ViewSpread::faces_12, ViewSpread::vertices_20, ViewSpread::both_32}) {
    const ViewSet set = whole(spread);
    const double zone = 0.2;
    const auto weights_at = [&](const glm::dvec3& direction) {
      std::array<int, 6> views;
      std::array<float, 6> weights;
      const int found = nearest_views(set, direction, views);
      handover_weights(set, direction, zone, std::span(views).first(found), weights);
      std::vector<double> all(set.directions.size(), 0.0);
      for (int k = 0; k < found; ++k) all[views[k]] = weights[k];
      return all;
    };
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 a = random_direction(rng);
      const glm::dvec3 b = glm::normalize(a + 1e-3 * random_direction(rng));
      const std::vector<double> wa = weights_at(a), wb = weights_at(b);
      double sum = 0;
      for (std::size_t k = 0; k < wa.size(); ++k) {
        sum += wa[k];
        // The angles move by at most a milliradian each: their difference by two, and the sum that
        // divides by five times that.
        EXPECT_NEAR(wa[k], wb[k], 12 * 1e-3 / zone);
      }
      EXPECT_NEAR(sum, 1.0, 1e-6);
    }
    // Alone at a view; with no zone alone everywhere.
    EXPECT_EQ(weights_at(set.directions[3])[3], 1.0);
    std::array<int, 2> views;
    std::array<float, 2> weights;
    nearest_views(set, {0.1, 0.2, 0.3}, views);
    handover_weights(set, {0.1, 0.2, 0.3}, 0.0, views, weights);
    EXPECT_EQ(weights, (std::array<float, 2>{1.0f, 0.0f}));
  }
}

TEST(ViewSet, hemisphere_keeps_the_upper_views_and_no_lid) {
  std::mt19937 rng(3);
  for (const glm::dvec3 up : {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 2), glm::dvec3(1, -2, 0.5)}) {
    const ViewSet set =
        make_view_set({.spread = ViewSpread::both_32, .hemisphere = true, .ring = 8, .up = up});
    const glm::dvec3 axis = glm::normalize(up);
    EXPECT_EQ(set.directions.size(), 20u);
    for (const glm::dvec3& d : set.directions) EXPECT_GE(glm::dot(d, axis), -1e-9);
    for (const auto& t : set.triangles) {
      // Outwards, and not across the open side.
      const glm::dvec3 normal = glm::cross(set.directions[t[1]] - set.directions[t[0]],
                                           set.directions[t[2]] - set.directions[t[0]]);
      EXPECT_GT(glm::dot(normal, set.directions[t[0]]), 0.0);
    }
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 direction = random_direction(rng);
      EXPECT_EQ(pick_views(set, direction).views[0], nearest_by_angle(set, direction));
      int held = 0;
      for (const auto& t : set.triangles) held += holds(set, t, direction, 1e-9);
      // The four views on the horizon are joined by great circles: above them all is covered.
      if (glm::dot(direction, axis) > 0.0) {
        EXPECT_EQ(held, 1);
      }
    }
  }
}

// The nearer view weighs more: as much as the way to the other one.
TEST(ViewSet, weights_of_a_rings_two_views_are_the_ways_to_the_other_one) {
  const ViewSet set = make_view_set({.spread = ViewSpread::ring, .ring = 6});
  for (const double share : {0.1, 0.25, 0.4}) {
    const double angle = share * 2 * std::numbers::pi / 6;
    const ViewPick pick = pick_views(set, {std::sin(angle), 0, std::cos(angle)});
    EXPECT_EQ(pick.views[0], 0);
    EXPECT_EQ(pick.views[1], 1);
    EXPECT_NEAR(pick.weights[0], 1 - share, 1e-9);
    EXPECT_NEAR(pick.weights[1], share, 1e-9);
    EXPECT_EQ(pick.weights[2], 0);
  }
}

TEST(ViewSet, ring_neighbours_are_the_two_beside) {
  std::mt19937 rng(4);
  const ViewSet set = make_view_set({.spread = ViewSpread::ring, .ring = 5});
  ASSERT_EQ(set.directions.size(), 5u);
  EXPECT_TRUE(set.triangles.empty());
  EXPECT_EQ(set.edges.size(), 5u);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 direction = random_direction(rng);
    const ViewPick pick = pick_views(set, direction);
    std::vector<int> order{0, 1, 2, 3, 4};
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return glm::dot(direction, set.directions[a]) > glm::dot(direction, set.directions[b]);
    });
    EXPECT_EQ(pick.views[0], order[0]);
    EXPECT_EQ(pick.views[1], order[1]);
    EXPECT_EQ(pick.views[2], -1);
  }
}

TEST(ViewSet, no_direction_is_farther_from_its_nearest_view_than_the_covering_angle) {
  std::mt19937 rng(8);
  for (ViewSpread spread : {ViewSpread::faces_12, ViewSpread::vertices_20, ViewSpread::both_32}) {
    const ViewSet set = whole(spread);
    const double covering = covering_angle(set);
    double farthest = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 direction = random_direction(rng);
      const int view = nearest_by_angle(set, direction);
      farthest = std::max(farthest, std::acos(glm::dot(direction, set.directions[view])));
    }
    EXPECT_LE(farthest, covering);
    EXPECT_GT(farthest, 0.98 * covering);  // 20 000 directions are a degree apart
  }
  EXPECT_EQ(covering_angle(make_view_set({.hemisphere = true})), std::numbers::pi);
  EXPECT_EQ(covering_angle(make_view_set({.spread = ViewSpread::ring})), std::numbers::pi);
}

TEST(ViewSet, directions_read_back_as_floats_give_the_same_neighbours) {
  for (ViewSpread spread :
       {ViewSpread::faces_12, ViewSpread::vertices_20, ViewSpread::both_32, ViewSpread::ring}) {
    const ViewSet set = whole(spread);
    std::vector<glm::dvec3> rounded;
    for (const glm::dvec3& d : set.directions)
      rounded.push_back(glm::normalize(glm::dvec3(glm::vec3(d))));
    const ViewSet again = view_set_from_directions(rounded);
    EXPECT_EQ(again.triangles, set.triangles);
    EXPECT_EQ(again.edges, set.edges);
  }
  const ViewSet one = view_set_from_directions({glm::dvec3(0, 0, 1)});
  EXPECT_EQ(pick_views(one, {0, 0, -1}).views, (std::array<int, 3>{0, -1, -1}));
  const ViewSet two = view_set_from_directions({glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0)});
  EXPECT_EQ(pick_views(two, {1, 0, 0.5}).views, (std::array<int, 3>{1, 0, -1}));
}

TEST(ViewSet, camera_holds_the_box_with_the_apex_on_the_right_side) {
  std::mt19937 rng(5);
  Box box;
  box.add({-1, 2, -3}), box.add({2, 2.5f, 1});
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 direction = random_direction(rng);
    for (Projection kind : {Projection::back_perspective, Projection::perspective}) {
      const Result<Camera> camera =
          view_camera(box, direction, {.projection = kind, .size = 64, .distance = 1.5});
      ASSERT_TRUE(camera.ok()) << camera.error().message();
      EXPECT_TRUE(validate(*camera).ok());
      EXPECT_EQ(camera->projection, kind);
      const glm::dvec3 from_center = camera->position() - glm::dvec3(box.center());
      EXPECT_NEAR(glm::length(from_center), 1.5 * double(box.radius()), 1e-6);
      EXPECT_GT(glm::dot(from_center, direction) * (kind == Projection::back_perspective ? -1 : 1),
                0);
      for (const glm::vec3& corner : box.corners()) {
        const glm::dvec3 raster = raster_from_world(*camera, corner);
        // 1e-6 texels: rounding of doubles.
        EXPECT_GE(std::min(raster.x, raster.y), -1e-6);
        EXPECT_LE(std::max(raster.x, raster.y), 64 + 1e-6);
        EXPECT_GE(raster.z, camera->z_near);
        EXPECT_LE(raster.z, camera->z_far);
      }
    }
  }
  EXPECT_FALSE(view_camera(Box{}, {0, 0, 1}, {}).ok());
}

}  // namespace
}  // namespace rilievo

// When does something baked stand for its object, or for a node of the hierarchy? The rule of
// policy.h, without OpenGL, over a kind that exists only here.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/policy.h"

namespace rilievo {
namespace {

// A ball-like object at the origin that turns by `spin` radians a frame.
MovingObject top(int frame, double spin, std::uint64_t triangles) {
  MovingObject object;
  const auto pose = [&](int f) { return glm::rotate(glm::dmat4(1), spin * f, {0.3, 1, 0.2}); };
  Box box;
  box.add({-1, -1, -1}), box.add({1, 1, 1});
  object.world_from_object = pose(frame);
  object.now_from_last = pose(frame) * glm::inverse(pose(frame - 1));
  object.box = transformed(glm::mat4(object.world_from_object), box);
  object.triangles = triangles;
  return object;
}

// Off by `metres` across the line of sight, and not to be drawn for eyes within `nearest` metres of
// the middle.
struct Terms {
  double metres = 0, nearest = 0;
};

double bound_px(const ErrorModel& model, const glm::dmat4& world_from_capture,
                const Camera& frame) {
  const Terms terms = model.load<Terms>();
  const double distance = glm::length(glm::dvec3(world_from_capture[3]) - frame.position());
  if (distance < terms.nearest) return std::numeric_limits<double>::infinity();
  return terms.metres / distance * frame.width / (frame.window.right - frame.window.left);
}

Alternatives alternative_of(const MovingObject& object, const Terms& terms, const CostTerms& cost) {
  Alternative one;
  one.error.bound = bound_px;
  one.error.store(terms);
  one.cost = cost;
  one.world_from_capture = object.world_from_object;
  return {{one}, {{0}}};
}

FrameView eye_at(double distance) {
  return {look_at({0.3 * distance, 0.2 * distance, distance}, {0, 0, 0}, {0, 1, 0}, 1.0472, 1280,
                  720, 0.1, 5000)};
}

struct AlternativesLoop {
  PlanMaker maker;
  CacheState state;
  PlanScratch scratch;
  Plan plan;
  void frame(const MovingObject& object, const Alternatives& alternatives, const FrameView& view,
             const CacheOptions& options = {}) {
    plan_frame({{}, {&object, 1}, alternatives, {}}, state, view, options, maker, scratch, plan);
    commit(plan, state);
  }
};

TEST(PolicyAlternatives, are_drawn_where_they_are_within_the_bound_and_cheaper) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0, 1);
  int drawn = 0, too_far_off = 0, too_dear = 0;
  for (int i = 0; i < 3000; ++i) {
    MovingObject object = top(0, 0, std::uint64_t(1000 * std::pow(1000, u(rng))));
    object.polygons_only = true;  // no pictures: polygons or the alternative
    const CostTerms cost{100 * std::pow(100, u(rng)), 2 * u(rng)};
    const Alternatives alternatives =
        alternative_of(object, {0.002 + 0.05 * u(rng), 2 * u(rng)}, cost);
    CacheOptions options;
    options.error_px = 0.25 * std::pow(16, u(rng));
    const FrameView view = eye_at(1.8 * std::pow(100, u(rng)));
    AlternativesLoop run;
    run.frame(object, alternatives, view, options);

    const double error_px =
        alternatives.list[0].error.bound_px(object.world_from_object, view.camera);
    const double pixels = covered_pixels(view_axes(view, 0), object.box);
    const bool within = error_px <= options.error_px;
    const bool cheaper =
        cost.fixed + pixels * cost.per_pixel <
        options.cost.object + double(object.triangles) + pixels * options.cost.polygon_pixel;
    ASSERT_EQ(run.plan.alternatives.size(), within && cheaper ? 1u : 0u) << i;
    ASSERT_EQ(run.plan.moving_polygons.size(), within && cheaper ? 0u : 1u) << i;
    ASSERT_NEAR(run.plan.bound_px, within && cheaper ? error_px : 0, 1e-6);
    drawn += within && cheaper, too_far_off += !within && cheaper, too_dear += within && !cheaper;
  }
  EXPECT_GT(drawn, 100);
  EXPECT_GT(too_far_off, 100);
  EXPECT_GT(too_dear, 100);
}

TEST(PolicyAlternatives, the_cheapest_of_several_is_drawn_and_none_that_is_absent) {
  MovingObject object = top(0, 0, 10'000'000);
  object.polygons_only = true;
  Alternatives alternatives = alternative_of(object, {1e-6, 0}, {3000, 0});
  alternatives.list.resize(3, alternatives.list[0]);
  alternatives.list[1].cost = {1000, 0};
  alternatives.list[2].cost = {2000, 0};
  alternatives.of_entity = {{0, 1, 2}};
  for (const std::uint32_t expected : {1u, 2u, 0u}) {
    AlternativesLoop run;
    run.frame(object, alternatives, eye_at(10));
    ASSERT_EQ(run.plan.alternatives.size(), 1u);
    EXPECT_EQ(run.plan.alternatives[0].alternative, expected);
    alternatives.list[expected].present = false;
  }
  AlternativesLoop run;
  run.frame(object, alternatives, eye_at(10));
  EXPECT_TRUE(run.plan.alternatives.empty());
  EXPECT_EQ(run.plan.moving_polygons.size(), 1u);
}

TEST(PolicyAlternatives, one_with_cracks_wider_than_the_limit_on_gaps_is_not_drawn) {
  MovingObject object = top(0, 0, 10'000'000);
  object.polygons_only = true;
  Alternatives alternatives = alternative_of(object, {1e-6, 0}, {1000, 0});
  alternatives.list[0].error.gap = [](const ErrorModel&, const glm::dmat4&, const Camera&) {
    return 1.5;
  };
  CacheOptions options;
  for (const double limit : {2.0, 1.0}) {
    options.gap_px = limit;
    AlternativesLoop run;
    run.frame(object, alternatives, eye_at(10), options);
    EXPECT_EQ(run.plan.alternatives.size(), limit > 1.5 ? 1u : 0u);
    EXPECT_DOUBLE_EQ(run.plan.gap_px, limit > 1.5 ? 1.5 : 0.0);
  }
}

TEST(PolicyAlternatives, what_spins_is_drawn_from_one_and_what_rests_from_a_picture) {
  for (const double spin : {0.3, 0.0}) {
    AlternativesLoop run;
    std::uint64_t captured = 0, polygons = 0;
    std::size_t alternatives_drawn = 0, pictures = 0;
    for (int f = 0; f < 40; ++f) {
      const MovingObject object = top(f, spin, 200'000);
      run.frame(object, alternative_of(object, {0.003, 2}, {3000, 0.9}), eye_at(14));
      if (f < 20) continue;  // a capture that pays late waits for up to 16 frames
      captured += run.plan.captured_triangles, polygons += run.plan.polygon_triangles;
      alternatives_drawn += run.plan.alternatives.size(), pictures += run.plan.pictures.size();
    }
    EXPECT_EQ(captured, 0u) << spin;
    EXPECT_EQ(polygons, 0u) << spin;
    EXPECT_EQ(alternatives_drawn, spin > 0 ? 20u : 0u);
    EXPECT_EQ(pictures, spin > 0 ? 0u : 20u);
  }
}

TEST(PolicyAlternatives, an_inner_node_is_drawn_from_one_alternative_for_all_its_objects) {
  std::vector<Box> boxes(4);
  for (int i = 0; i < 4; ++i) {
    boxes[std::size_t(i)].add({2.0f * float(i), 0, 0});
    boxes[std::size_t(i)].add({2.0f * float(i) + 1, 1, 1});
  }
  const std::vector<std::uint64_t> triangles(4, 1'000'000);
  const Hierarchy tree = build_hierarchy(boxes, triangles);
  CacheOptions options;
  options.picture_triangles = 0;  // no picture of several objects ...
  options.max_texels = 1;         // ... and none of one
  for (const bool dear : {false, true}) {
    Alternatives alternatives = alternative_of({}, {1e-6, 0}, {dear ? 1e9 : 1000, 0});
    alternatives.of_entity.assign(tree.nodes.size(), {});
    alternatives.of_entity[0] = {0};  // the root
    PlanMaker maker;
    CacheState state;
    PlanScratch scratch;
    Plan plan;
    for (int f = 0; f < 3; ++f) {
      const FrameView view{look_at({4, 3, 20}, {4, 0, 0}, {0, 1, 0}, 1.0, 640, 480, 0.1, 100)};
      plan_frame({tree, {}, alternatives, {}}, state, view, options, maker, scratch, plan);
      commit(plan, state);
      EXPECT_EQ(plan.alternatives.size(), dear ? 0u : 1u);
      EXPECT_EQ(plan.polygons.size(), dear ? 4u : 0u);
    }
  }
}

}  // namespace
}  // namespace rilievo

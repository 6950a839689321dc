#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>

#include "rilievo/cache/plan/spike_test_helpers.h"

namespace rilievo {
namespace {

TEST(Spike, a_frame_after_a_cut_costs_what_it_may_and_shows_all_until_it_is_fine) {
  std::mt19937 rng(11);
  int coarse = 0, cuts = 0;
  // The blocks cost 7 million.
  for (const auto& [step, floor, captures] : {std::tuple(0.0, 180'000, 100),
                                              {0.02, 180'000, 3},
                                              {0.02, 3'000'000, 3},
                                              {0.3, 180'000, 100}}) {
    const PlanObjects blocks = blocks_of_all_sizes(rng);
    CacheOptions options = limited_options();
    options.spikes.floor = floor;
    Loop run;
    run.maker.room = std::size_t(captures);
    EyeMotion motion = walking_elsewhere();
    double limit = 0, usual = 0;  // before the frame
    for (int frame = 0; frame < 160; ++frame) {
      const FrameView view = follow(motion, walking(frame, step));
      usual = run.state.usual_cost;
      ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
      std::vector<Shares> still(blocks.boxes.size()), moving;
      add_shares(run, blocks.tree, still, moving);
      const ViewAxes axes = view_axes(view, 0);
      for (std::size_t i = 0; i < still.size(); ++i)
        EXPECT_TRUE(complete(still[i]) || !may_see(axes.now, blocks.boxes[i])) << i;
      // Texels of two pixels at most: rays are cheap here.
      EXPECT_LE(run.plan.bound_px, options.error_px + std::sqrt(0.5) + 1e-9);
      const double cost = cost_of(run, blocks, view, options);
      if (run.plan.fallback.objects.empty()) {
        EXPECT_NEAR(run.plan.cost, cost, 1e-6 * cost);
      } else {
        ++coarse;
        // From texel to texel across.
        const Camera &coarser = run.plan.fallback.geometry.capture, &frames = view.camera;
        const ImageWindow &small = coarser.window, &whole = frames.window;
        const double between = std::hypot(
            (small.right - small.left) / coarser.width * kWidth / (whole.right - whole.left),
            (small.top - small.bottom) / coarser.height * kHeight / (whole.top - whole.bottom));
        EXPECT_GE(run.plan.gap_px * (1 + 1e-9), between);
        // One object, of 60 000 triangles at most, is moved too few or too many; and one capture of
        // any size is always allowed. The coarse picture may be finer where there is room.
        EXPECT_LE(cost, run.plan.limit + 60'000 + 0.1 * run.plan.limit) << frame;
      }
      if (frame % 20 == 0) {
        ++cuts;
        EXPECT_TRUE(run.plan.limit == 0 ||
                    run.plan.limit == options.spikes.jump_share * options.spikes.floor)
            << frame;
      } else if (limit > 0 && run.plan.limit > 0) {
        // A third more than the last frame's or the floor, and no more than twice what the last
        // ones cost, or half of it all.
        double all = 0;
        for (std::size_t i = 0; i < still.size(); ++i)
          if (may_see(axes.now, blocks.boxes[i])) all += polygon_cost(blocks, i, axes, options);
        const double spike = std::max(options.spikes.floor, 2 * usual);
        const double last = std::max(limit, options.spikes.floor);
        EXPECT_LE(run.plan.limit,
                  std::max({last, std::min(1.3 * last, spike), all / 2}) * (1 + 1e-9));
        EXPECT_GE(run.plan.limit, last);
      }
      limit = run.plan.limit;
      // 1.3^12 = 23 floors are more than all of the blocks cost.
      if (frame % 20 >= 12) {
        EXPECT_TRUE(run.plan.fallback.objects.empty()) << frame;
      }
    }
  }
  EXPECT_GT(coarse, cuts);
}

// The cheapest object that is coarse, and the dearest that is drawn as polygons.
template <class Cost>
std::pair<double, double> cheapest_and_dearest(const Plan& plan, const Cost& cost_of_object) {
  double cheapest = INFINITY, dearest = 0;
  for (const std::uint32_t object : plan.fallback.objects)
    cheapest = std::min(cheapest, cost_of_object(object));
  for (const DrawnObject& drawn : plan.polygons)
    dearest = std::max(dearest, cost_of_object(drawn.object));
  return {cheapest, dearest};
}

TEST(Spike, the_dearest_polygons_are_coarse_and_no_more_of_them_than_must_be) {
  std::mt19937 rng(12);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  Loop run;
  run.maker.room = 1;
  EyeMotion motion = walking_elsewhere();
  const FrameView view = follow(motion, walking(0, 0));
  ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
  ASSERT_GT(run.plan.fallback.objects.size(), 10u);
  ASSERT_GT(run.plan.polygons.size(), 10u);
  const ViewAxes axes = view_axes(view, 0);
  const auto [cheapest, dearest] = cheapest_and_dearest(
      run.plan, [&](std::uint32_t object) { return polygon_cost(blocks, object, axes, options); });
  EXPECT_GE(cheapest, dearest * (1 - 1e-6));
  // The cheapest of them as polygons would be too much.
  EXPECT_LE(run.plan.cost, run.plan.limit);
  EXPECT_GT(run.plan.cost + cheapest, run.plan.limit);
}

// Most of their triangles were found to be hidden, of some more than of others.
TEST(Spike, polygons_count_in_limited_frames_as_what_they_took) {
  std::mt19937 rng(17);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  Loop run;
  run.maker.room = 1;
  run.state.current.assign(blocks.tree.nodes.size(), 0);
  run.state.previous = run.state.current;
  run.state.frame = 1;
  std::vector<PolygonCost> took;
  std::vector<double> share(blocks.boxes.size());
  for (Entity e = 0; e < blocks.tree.nodes.size(); ++e) {
    if (!blocks.tree.nodes[e].leaf()) continue;
    double& of_object = share[blocks.tree.order[blocks.tree.nodes[e].first]];
    of_object = 0.1 + 0.001 * double(rng() % 500);
    took.push_back({e, 1000, 1000 * of_object});
  }
  learn_polygons(took, run.state);
  EyeMotion motion = walking_elsewhere();
  const FrameView view = follow(motion, walking(0, 0));
  ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
  ASSERT_GT(run.plan.fallback.objects.size(), 5u);
  ASSERT_GT(run.plan.polygons.size(), 5u);
  const ViewAxes axes = view_axes(view, 0);
  const auto cost_by_share = [&](std::uint32_t object) {
    return share[object] * polygon_cost(blocks, object, axes, options);
  };
  const auto [cheapest, dearest] = cheapest_and_dearest(run.plan, cost_by_share);
  double cost = 0;
  for (const DrawnObject& drawn : run.plan.polygons) {
    EXPECT_NEAR(drawn.expected_cost, polygon_cost(blocks, drawn.object, axes, options), 1);
    cost += cost_by_share(drawn.object);
  }
  EXPECT_GE(cheapest, dearest * (1 - 1e-6));
  for (const DrawnPicture& drawn : run.plan.pictures) cost += run.state.slots[drawn.slot].draw_cost;
  for (const Capture& capture : run.plan.captures) cost += capture.cost;
  cost += options.cost.fallback_texel * kWidth * kHeight / 4;  // as coarse as it may be
  EXPECT_NEAR(run.plan.cost, cost, 1e-6 * cost);
  // No more than it may, and the cheapest of them as polygons would be too much.
  EXPECT_LE(cost, run.plan.limit);
  EXPECT_GT(cost + cheapest, run.plan.limit);
}

TEST(Spike, without_a_limit_and_below_the_floor_nothing_is_coarse) {
  std::mt19937 rng(13);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options[2] = {limited_options(), limited_options()};
  options[0].spikes.max_spike = 0;
  options[1].spikes.floor = 1e9;
  for (const CacheOptions& one : options) {
    Loop run;
    EyeMotion motion;
    for (int frame = 0; frame < 60; ++frame) {
      const FrameView view = follow(motion, walking(frame, 0.02));
      ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, one));
      EXPECT_TRUE(run.plan.fallback.objects.empty());
      EXPECT_EQ(run.plan.limit, 0);
      EXPECT_LE(run.plan.bound_px, one.error_px);
    }
  }
}

// Rays for the whole frame may cost more than the frame may: then they are fewer.
TEST(Spike, after_a_jump_the_coarse_picture_leaves_a_share_of_the_limit) {
  std::mt19937 rng(17);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  // With half as many texels across and up, 58 000 of them; the limit is 117 000.
  for (const auto& [texel, scale] : {std::pair(1.0, 0.5), {4.0, 0.3187}, {20.0, 0.25}}) {
    CacheOptions options = limited_options();
    options.cost.fallback_texel = texel;
    Loop run;
    run.maker.room = 3;  // it takes some frames until all is fine
    EyeMotion motion = walking_elsewhere();
    int coarse = 0, coarse_later = 0;
    for (int frame = 0; frame < 60; ++frame) {
      const FrameView view = follow(motion, walking(frame, 0.02));
      ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
      if (run.plan.fallback.objects.empty()) continue;
      const double pixels = 1 / run.plan.fallback.texel_px;
      if (frame % 20 > 0) {
        ++coarse_later;
        EXPECT_GE(pixels, 0.5 - 1e-9) << frame;
      } else {
        ++coarse;
        // Within a texel or two of the frame, and finer where polygons left something.
        EXPECT_GE(pixels, scale - 1e-3) << frame;
        EXPECT_LE(pixels, 1.2 * scale) << frame;
      }
    }
    EXPECT_EQ(coarse, 3);
    EXPECT_GT(coarse_later, 3);
  }
}

TEST(Spike, the_first_step_of_an_eye_that_stood_is_a_jump_only_if_it_costs_like_one) {
  std::mt19937 rng(15);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  const CacheOptions options = limited_options();
  for (const bool jump : {false, true}) {
    Loop run;
    EyeMotion motion;
    for (int frame = 0; frame < 10; ++frame) {
      const FrameView view = follow(motion, walking(0, 0));
      ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
      EXPECT_EQ(run.plan.limit, 0);
    }
    const FrameView view = follow(motion, jump ? walking(20, 0) : walking(1, 0.02));
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    EXPECT_EQ(run.plan.limit, jump ? options.spikes.jump_share * options.spikes.floor : 0);
    EXPECT_EQ(run.plan.fallback.objects.empty(), !jump);
  }
}

TEST(Spike, the_first_step_of_an_eye_that_stood_is_a_jump_where_all_that_it_saw_shifts) {
  std::mt19937 rng(16);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  options.spikes.max_spike = 1e6;  // no cost is above that
  // By definition: the mean of step / distance of the pictures shown.
  int jumps = 0, steps = 0;
  for (const double step : {0.5, 2.0, 8.0, 20.0, 30.0, 50.0}) {
    Loop run;
    EyeMotion motion;
    for (int frame = 0; frame < 10; ++frame)
      ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, follow(motion, walking(0, 0)), options));
    double shift = 0;
    for (const DrawnPicture& drawn : run.plan.pictures)
      shift += step / run.state.slots[drawn.slot].geometry.plane_z;
    ASSERT_GT(run.plan.pictures.size(), 20u);
    shift /= double(run.plan.pictures.size());
    const FrameView view = follow(motion, walking(1, step));
    EXPECT_TRUE(view.started && !view.jumped);
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    EXPECT_EQ(run.plan.limit, shift > 0.25 ? options.spikes.jump_share * options.spikes.floor : 0)
        << shift;
    ++(shift > 0.25 ? jumps : steps);
  }
  EXPECT_GT(jumps, 1);
  EXPECT_GT(steps, 1);
}

// Of each node, a quarter of the triangles less for each step, from 2 cm on.
LevelTable quarters_less(const PlanObjects& blocks) {
  LevelTable levels{0.02, {}};
  for (const HierarchyNode& node : blocks.tree.nodes) {
    auto& entries = levels.of_node.emplace_back();
    for (int step = 0; step < LevelTable::kSteps; ++step)
      entries[std::size_t(step)] = {float(double(node.triangles) * std::pow(0.75, step)),
                                    float(0.02 * std::exp2(0.5 * step))};
  }
  return levels;
}

std::uint64_t leveled_triangles(std::uint64_t triangles, double error) {
  const double step = std::round(2 * std::log2(error / 0.02));
  return error > 0 ? std::uint64_t(float(double(triangles) * std::pow(0.75, step))) : triangles;
}

TEST(Spike, levels_of_detail_cost_their_triangles_in_limited_frames_too) {
  std::mt19937 rng(14);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  const LevelTable levels = quarters_less(blocks);
  CacheOptions options = limited_options();
  options.spikes.floor = 180'000;
  Loop run;
  EyeMotion motion = walking_elsewhere();
  int coarse = 0, by_level = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const FrameView view = follow(motion, walking(frame, 0.02));
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options, {}, levels));
    double cost = cost_of(run, blocks, view, options);  // of all triangles
    std::uint64_t triangles = 0;
    for (const DrawnObject& drawn : run.plan.polygons) {
      const std::uint64_t all = blocks.triangles[drawn.object],
                          left = leveled_triangles(all, double(drawn.level_error));
      cost -= double(all - left);
      triangles += left;
      by_level += drawn.level_error > 0;
    }
    EXPECT_EQ(run.plan.polygon_triangles, triangles);
    if (run.plan.fallback.objects.empty()) {
      EXPECT_NEAR(run.plan.cost, cost, 1e-6 * cost);
    } else {
      ++coarse;
      EXPECT_LE(cost, 1.1 * run.plan.limit + 60'000) << frame;
    }
  }
  EXPECT_GE(coarse, 5);  // after each cut
  EXPECT_GT(by_level, 100);
}

}  // namespace
}  // namespace rilievo

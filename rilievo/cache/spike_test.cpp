#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "rilievo/cache/capture_cost.h"
#include "rilievo/cache/eye_motion.h"
#include "rilievo/cache/plan_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kWidth = 640, kHeight = 360;

// Blocks of 200 to 60 000 triangles, 4 m apart.
PlanObjects blocks_of_all_sizes(std::mt19937& rng) {
  PlanObjects blocks;
  for (int j = -8; j < 8; ++j)
    for (int i = -8; i < 8; ++i) {
      Box box;
      box.add({4 * i - 1, 0, 4 * j - 1}), box.add({4 * i + 1, 3, 4 * j + 1});
      blocks.add(box, 200 + rng() % 60'000);
    }
  blocks.build();
  return blocks;
}

// Walks along an edge of the blocks for 20 frames, and jumps to another place.
Camera walking(int frame, double step) {
  const int jump = frame / 20;
  const glm::dvec3 eye(60 * std::cos(2.0 * jump), 6, 60 * std::sin(2.0 * jump));
  const glm::dvec3 aside = step * (frame % 20) * glm::dvec3(0, 0, 1);
  return look_at(eye + aside, glm::dvec3(0, 1, 0) + aside, {0, 1, 0}, 1.0, kWidth, kHeight, 0.1,
                 400);
}

EyeMotion walking_elsewhere() {
  EyeMotion motion;
  for (const int frame : {58, 59}) (void)follow(motion, walking(frame, 0.01));
  return motion;
}

double polygon_cost(const PlanObjects& blocks, std::size_t i, const ViewAxes& axes,
                    const CacheOptions& options) {
  return options.cost.object + double(blocks.triangles[i]) +
         options.cost.polygon_pixel * covered_pixels(axes, blocks.boxes[i]);
}

// By definition: what the plan draws and captures, and a coarse picture of the frame's size.
double cost_of(const Loop& run, const PlanObjects& blocks, const FrameView& view,
               const CacheOptions& options) {
  const ViewAxes axes = view_axes(view, 0);
  const CostModel& model = options.cost;
  double cost = 0;
  for (const DrawnPicture& drawn : run.plan.pictures) cost += run.state.slots[drawn.slot].draw_cost;
  for (const DrawnObject& drawn : run.plan.polygons)
    cost += polygon_cost(blocks, drawn.object, axes, options);
  for (const Capture& capture : run.plan.captures) cost += capture.cost;
  if (!run.plan.fallback.objects.empty()) {
    const Camera& eye = run.plan.fallback.geometry.capture;
    cost += model.fallback_texel * eye.width * eye.height;
  }
  return cost;
}

CacheOptions limited_options() {
  CacheOptions options = rasterized_cache_options();
  options.max_spike = 2;
  options.spike_floor = 180'000;
  options.picture_triangles = 200'000;
  options.capture_triangles = 2'000'000;
  return options;
}

// Of the plan: what captures cost beyond what drawing the same objects otherwise would, without the
// first one, which is always allowed.
double captured_beyond(const Loop& run) {
  double beyond = 0;
  for (std::size_t i = 1; i < run.plan.captures.size(); ++i) {
    const Capture& capture = run.plan.captures[i];
    beyond += std::max(0.0, capture.cost - double(run.scratch.now_cost[capture.entity]));
  }
  return beyond;
}

TEST(Spike, captures_do_not_make_a_frame_of_a_walk_cost_much_more_than_those_before) {
  std::mt19937 rng(12);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  // Captures are dear, and polygons are within what any frame may cost.
  options.cost.capture_triangle = 3;
  options.capture_triangles = 1'500'000;
  options.spike_floor = 10'000'000;
  const auto most_beyond = [&](bool second) {
    Loop run;
    EyeMotion motion;
    double most = 0;
    for (int frame = 0; frame < 20; ++frame) {
      const double usual = run.state.usual_cost;
      run.frame(blocks.tree, {}, follow(motion, walking(frame, 0.05)), options);
      if (frame == 0 || (frame == 1) != second) continue;
      const double allowed =
          second ? 0.2 * options.spike_floor : std::max(0.4 * options.spike_floor, 2 * usual);
      if (options.max_spike > 0) {
        EXPECT_LE(captured_beyond(run), allowed * (1 + 1e-6)) << frame;
      }
      most = std::max(most, captured_beyond(run));
    }
    return most;
  };
  const double second = most_beyond(true), later = most_beyond(false);
  options.max_spike = 0;  // without the limit
  EXPECT_GT(most_beyond(true), 1.5 * second);
  EXPECT_GT(second + later, 0);
}

TEST(Spike, the_first_frame_captures_nothing_before_it_is_known_how_the_eye_moves) {
  std::mt19937 rng(14);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  for (const bool limited : {true, false}) {
    CacheOptions options = limited_options();
    if (!limited) options.max_spike = 0;
    Loop run;
    EyeMotion motion;
    run.frame(blocks.tree, {}, follow(motion, walking(0, 0.05)), options);
    EXPECT_EQ(run.plan.captures.empty(), limited);
    if (!limited) continue;
    EXPECT_EQ(run.plan.bound_px, 0);
    EXPECT_TRUE(run.plan.fallback.objects.empty());
    run.frame(blocks.tree, {}, follow(motion, walking(1, 0.05)), options);
    EXPECT_GT(run.plan.captures.size(), 100u);  // of 256 blocks
  }
}

// By definition: how much captures may add where a frame costs `at_hand` without them, if it need
// not be limited. The last frames cost `usual`, and the last one's limit was `limit`, if it had
// one.
double room_for_captures(const CacheOptions& options, double usual, double limit, double at_hand) {
  const double spike = std::max(options.spike_floor, options.max_spike * usual);
  const double allowed =
      limit > 0 ? std::max({limit, std::min(1.3 * limit, spike), 0.5 * at_hand}) : spike;
  const double walk = std::max(0.4 * options.spike_floor, options.max_spike * usual);
  return at_hand <= allowed ? std::max(0.0, std::min(allowed, walk) - at_hand) : -1;
}

TEST(Spike, captures_find_room_within_what_a_frame_may_cost_and_free_ones_always) {
  std::mt19937 rng(18);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  std::uniform_real_distribution<double> u(-1, 0.3);
  int frames = 0, limited_before = 0, filled = 0, without_room = 0, nearly_free = 0;
  for (int round = 0; round < 400; ++round) {
    CacheOptions options = limited_options();
    // Some captures cost less than the polygons that they spare, some more.
    options.cost.capture_triangle = 0.5 + 0.002 * double(rng() % 1000);
    options.cost.capture_texel = 0.1;
    options.capture_triangles = 20'000'000;
    Loop run;
    EyeMotion motion;
    FrameView view = follow(motion, walking(round, 0.02));
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    std::vector<std::uint32_t> evictions;
    invalidate(run.state, evictions);  // polygons alone are at hand, as in that frame
    run.textures.clear();
    const auto about = [&] { return double(run.scratch.now_cost[0]) * std::pow(10, u(rng)); };
    options.spike_floor = (round % 3 ? 1 : 5) * about();
    const double usual = run.state.usual_cost = about();
    const double limit = run.state.limit = round % 2 ? about() : 0;
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    const double room = room_for_captures(options, usual, limit, double(run.scratch.now_cost[0]));
    EXPECT_EQ(run.plan.limit > 0, room < 0) << round;
    if (room < 0) continue;
    EXPECT_GE(run.plan.credit, 0);
    const double beyond = captured_beyond(run);
    EXPECT_LE(beyond, room * (1 + 1e-6)) << round;
    for (const PlanScratch::Request& request : run.scratch.requests) {
      if (request.deadline > 0 || request.cost > run.scratch.now_cost[request.entity]) continue;
      const bool made =
          std::any_of(run.plan.captures.begin(), run.plan.captures.end(),
                      [&](const Capture& capture) { return capture.entity == request.entity; });
      nearly_free += room == 0 && made;
      if (room == 0) {
        EXPECT_TRUE(made) << round;
      }
    }
    // The first that is not made, of those that are due, would not have found room beside those
    // before it.
    double spent = 0;
    for (const PlanScratch::Request& request : run.scratch.requests) {
      if (request.deadline > 0) break;
      const double extra =
          std::max(0.0, double(request.cost) - double(run.scratch.now_cost[request.entity]));
      const bool made =
          std::any_of(run.plan.captures.begin(), run.plan.captures.end(),
                      [&](const Capture& capture) { return capture.entity == request.entity; });
      if (!made) {
        EXPECT_GT(spent + extra, room * (1 - 1e-6)) << round;
        break;
      }
      spent += extra;
    }
    ++frames, limited_before += limit > 0;
    filled += room > 0 && beyond > 0.5 * room, without_room += room == 0;
  }
  EXPECT_GT(frames, 100);
  EXPECT_GT(limited_before, 30);
  EXPECT_GT(filled, 20);
  EXPECT_GT(without_room, 10);
  EXPECT_GT(nearly_free, 100);
}

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
    options.spike_floor = floor, options.captures = captures;
    Loop run;
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
      // Texels of two pixels at most.
      EXPECT_LE(run.plan.bound_px, options.error_px + std::sqrt(0.5) + 1e-9);
      const double cost = cost_of(run, blocks, view, options);
      if (run.plan.fallback.objects.empty()) {
        EXPECT_NEAR(run.plan.cost, cost, 1e-6 * cost);
      } else {
        ++coarse;
        // Between texels of two pixels; also when a capture's own gaps have become known.
        const double between = std::sqrt(2.0) * kWidth / run.plan.fallback.geometry.capture.width;
        EXPECT_GE(run.plan.gap_px * (1 + 1e-9), between);
        if (!run.plan.captures.empty()) {
          Plan reported = run.plan;
          const Capture& capture = reported.captures[0];
          (void)narrow_capture(reported, 0, view.camera, {0, 1}, options, capture.picture.gaps);
          EXPECT_GE(reported.gap_px * (1 + 1e-9), between);
        }
        // One object, of 60 000 triangles at most, is moved too few or too many; and one capture of
        // any size is always allowed. The coarse picture may be finer where there is room.
        EXPECT_LE(cost, run.plan.limit + 60'000 + 0.1 * run.plan.limit) << frame;
      }
      if (frame % 20 == 0) {
        ++cuts;
        EXPECT_TRUE(run.plan.limit == 0 || run.plan.limit == options.spike_floor) << frame;
      } else if (limit > 0 && run.plan.limit > 0) {
        // A third more, and no more than twice what the last ones cost, or half of it all.
        double all = 0;
        for (std::size_t i = 0; i < still.size(); ++i)
          if (may_see(axes.now, blocks.boxes[i])) all += polygon_cost(blocks, i, axes, options);
        const double spike = std::max(options.spike_floor, 2 * usual);
        EXPECT_LE(run.plan.limit,
                  std::max({limit, std::min(1.3 * limit, spike), all / 2}) * (1 + 1e-9));
        EXPECT_GE(run.plan.limit, limit);
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

TEST(Spike, the_dearest_polygons_are_coarse_and_no_more_of_them_than_must_be) {
  std::mt19937 rng(12);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  options.captures = 0;  // but the one that is always allowed
  Loop run;
  EyeMotion motion = walking_elsewhere();
  const FrameView view = follow(motion, walking(0, 0));
  ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
  ASSERT_GT(run.plan.fallback.objects.size(), 10u);
  ASSERT_GT(run.plan.polygons.size(), 10u);
  const ViewAxes axes = view_axes(view, 0);
  double cheapest = INFINITY, dearest = 0;
  for (const std::uint32_t object : run.plan.fallback.objects)
    cheapest = std::min(cheapest, polygon_cost(blocks, object, axes, options));
  for (const DrawnObject& drawn : run.plan.polygons)
    dearest = std::max(dearest, polygon_cost(blocks, drawn.object, axes, options));
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
  options.captures = 0;  // but the one that is always allowed
  Loop run;
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
  double cheapest = INFINITY, dearest = 0, cost = 0;
  for (const std::uint32_t object : run.plan.fallback.objects)
    cheapest = std::min(cheapest, cost_by_share(object));
  for (const DrawnObject& drawn : run.plan.polygons) {
    EXPECT_NEAR(drawn.expected_cost, polygon_cost(blocks, drawn.object, axes, options), 1);
    dearest = std::max(dearest, cost_by_share(drawn.object));
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
  options[0].max_spike = 0;
  options[1].spike_floor = 1e9;
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
    EXPECT_EQ(run.plan.limit, jump ? options.spike_floor : 0);
    EXPECT_EQ(run.plan.fallback.objects.empty(), !jump);
  }
}

TEST(Spike, the_first_step_of_an_eye_that_stood_is_a_jump_where_all_that_it_saw_shifts) {
  std::mt19937 rng(16);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  options.max_spike = 1e6;  // no cost is above that
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
    EXPECT_EQ(run.plan.limit, shift > 0.25 ? options.spike_floor : 0) << shift;
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
  options.spike_floor = 180'000;
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

TEST(EyeMotion, a_jump_is_told_from_a_motion_that_becomes_faster) {
  EyeMotion motion;
  const auto at = [](double x) {
    return look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}, 1.0, kWidth, kHeight, 0.1, 100);
  };
  for (int frame = 0; frame < 2; ++frame) {
    const FrameView view = follow(motion, at(0));
    EXPECT_FALSE(view.jumped || view.started);
    EXPECT_EQ(view.step, 0);
  }
  const FrameView first_step = follow(motion, at(0.1));
  EXPECT_FALSE(first_step.jumped);
  EXPECT_TRUE(first_step.started);
  EXPECT_DOUBLE_EQ(first_step.step, 0.1);
  EXPECT_FALSE(follow(motion, at(0.1)).started);
  EXPECT_FALSE(follow(motion, at(0.2)).jumped);
  EXPECT_FALSE(follow(motion, at(0.8)).jumped);  // a frame that took six times as long
  EXPECT_FALSE(follow(motion, at(0.9)).jumped);
  EXPECT_TRUE(follow(motion, at(6)).jumped);
  for (int frame = 0; frame < 3; ++frame) EXPECT_FALSE(follow(motion, at(6)).jumped);
  EXPECT_FALSE(follow(motion, at(6.1)).jumped);  // it walks again
  EXPECT_TRUE(follow(motion, at(0)).jumped);     // a jump is not what it may be compared with
  EXPECT_FALSE(follow(motion, at(5.1)).jumped);  // or else a motion, if it goes on
  EXPECT_FALSE(follow(motion, at(5.2)).jumped);
  const auto turned = [&](double x, double radians) {
    return look_at({x, 0, 0}, {x + std::sin(radians), 0, -std::cos(radians)}, {0, 1, 0}, 1.0,
                   kWidth, kHeight, 0.1, 100);
  };
  EXPECT_FALSE(follow(motion, turned(5.3, 0.05)).jumped);
  EXPECT_FALSE(follow(motion, turned(5.4, 0.1)).jumped);
  EXPECT_TRUE(follow(motion, turned(5.5, 1.5)).jumped);
  // The first turn of an eye that stood.
  for (const double turn : {0.4, 0.6}) {
    EyeMotion standing;
    for (int frame = 0; frame < 2; ++frame) (void)follow(standing, turned(0, 0));
    const FrameView view = follow(standing, turned(0, turn));
    EXPECT_TRUE(view.started);
    EXPECT_EQ(view.jumped, turn > 0.5);
  }
}

}  // namespace
}  // namespace rilievo

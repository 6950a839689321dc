// How much captures may add to a frame's cost where it need not be limited (frame_limit.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rilievo/cache/plan/spike_test_helpers.h"

namespace rilievo {
namespace {

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

TEST(CaptureRoom, captures_do_not_make_a_frame_of_a_walk_cost_much_more_than_those_before) {
  std::mt19937 rng(12);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  CacheOptions options = limited_options();
  // Captures are dear, and polygons are within what any frame may cost.
  options.cost.capture_triangle = 3;
  options.capture_triangles = 1'500'000;
  options.spikes.floor = 10'000'000;
  const auto most_beyond = [&](bool second) {
    Loop run;
    EyeMotion motion;
    double most = 0;
    for (int frame = 0; frame < 20; ++frame) {
      const double usual = run.state.usual_cost;
      run.frame(blocks.tree, {}, follow(motion, walking(frame, 0.05)), options);
      if (frame == 0 || (frame == 1) != second) continue;
      const double allowed =
          second ? 0.2 * options.spikes.floor : std::max(0.4 * options.spikes.floor, 2 * usual);
      if (options.spikes.max_spike > 0) {
        EXPECT_LE(captured_beyond(run), allowed * (1 + 1e-6)) << frame;
      }
      most = std::max(most, captured_beyond(run));
    }
    return most;
  };
  const double second = most_beyond(true), later = most_beyond(false);
  options.spikes.max_spike = 0;  // without the limit
  EXPECT_GT(most_beyond(true), 1.5 * second);
  EXPECT_GT(second + later, 0);
}

TEST(CaptureRoom, the_first_frame_captures_nothing_before_it_is_known_how_the_eye_moves) {
  std::mt19937 rng(14);
  const PlanObjects blocks = blocks_of_all_sizes(rng);
  for (const bool limited : {true, false}) {
    CacheOptions options = limited_options();
    if (!limited) options.spikes.max_spike = 0;
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
  const double spike = std::max(options.spikes.floor, options.spikes.max_spike * usual);
  const double last = std::max(limit, options.spikes.floor);
  const double allowed =
      limit > 0 ? std::max({last, std::min(1.3 * last, spike), 0.5 * at_hand}) : spike;
  const double walk = std::max(0.4 * options.spikes.floor, options.spikes.max_spike * usual);
  return at_hand <= allowed ? std::max(0.0, std::min(allowed, walk) - at_hand) : -1;
}

TEST(CaptureRoom, captures_find_room_within_what_a_frame_may_cost_and_free_ones_always) {
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
    options.spikes.floor = (round % 3 ? 1 : 5) * about();
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

}  // namespace
}  // namespace rilievo

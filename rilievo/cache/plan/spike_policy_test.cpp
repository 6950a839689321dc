#include "rilievo/cache/plan/spike_policy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rilievo {
namespace {

// The table at the head of spike_policy.h, in its words.
double allowed(const SpikePolicy& policy, const FrameCosts& costs, bool jump) {
  const double spike = std::max(policy.floor, policy.max_spike * costs.usual);
  if (jump) return policy.jump_share * policy.floor;
  if (costs.last_limit == 0) return spike;
  const double last = std::max(costs.last_limit, policy.floor);
  return std::max({last, std::min(1.3 * last, spike), costs.now / 2});
}

TEST(SpikePolicy, limits_are_those_of_the_table) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(0, 1);
  int limited = 0, jumps = 0, found = 0;
  for (int i = 0; i < 10'000; ++i) {
    SpikePolicy policy;
    policy.max_spike = 1 + 3 * u(rng);
    policy.floor = 1e5 * (1 + u(rng));
    FrameCosts costs;
    costs.usual = 1e5 * std::max(0.0, 4 * u(rng) - 1);
    costs.now = 1e6 * u(rng);
    costs.last_limit = 4e5 * std::max(0.0, 2 * u(rng) - 1);
    costs.jumped = rng() % 4 == 0;
    costs.started = rng() % 4 == 0;
    costs.shift = 0.5 * u(rng);
    const FrameLimit limit = find_limit(policy, costs);
    const double walk = policy.max_spike * costs.usual, spike = std::max(policy.floor, walk);
    if (costs.usual == 0 && !costs.jumped) {  // nothing that moves is interrupted
      EXPECT_EQ(limit.limit, 0);
      EXPECT_EQ(limit.capture_room, 0.2 * policy.floor);
      continue;
    }
    const bool jump = costs.jumped || (costs.started && (costs.now > spike || costs.shift > 0.25));
    EXPECT_EQ(limit.jumped, jump);
    const double most = allowed(policy, costs, jump);
    EXPECT_EQ(limit.limit > 0, costs.now > most) << i;
    if (limit.limit > 0) {
      ++limited, jumps += jump;
      EXPECT_LE(limit.limit, most);
      EXPECT_LE(limited_capture_budget(limit), limit.limit / 2);
    } else {
      ++found;
      EXPECT_EQ(limit.capture_room,
                std::max(0.0, std::min(most, std::max(0.4 * policy.floor, walk)) - costs.now));
    }
  }
  EXPECT_GT(limited - jumps, 500);
  EXPECT_GT(jumps, 500);
  EXPECT_GT(found, 500);
}

TEST(SpikePolicy, without_a_limit_captures_have_all_room) {
  const FrameLimit limit = find_limit({}, {.jumped = true, .now = 1e9, .usual = 1});
  EXPECT_EQ(limit.limit, 0);
  EXPECT_FALSE(limit.captures_wait);
  EXPECT_EQ(limit.capture_room, std::numeric_limits<double>::infinity());
}

TEST(SpikePolicy, the_coarse_picture_leaves_a_share_of_the_limit_after_a_jump) {
  const FrameLimit jump{.limit = 1000, .jumped = true}, walk{.limit = 1000};
  EXPECT_EQ(coarsest_fallback(walk, 1e6, 0.5), 0.5);
  // Its cost goes with the square of its scale: from 0.8 of the limit on it is coarser.
  EXPECT_EQ(coarsest_fallback(jump, 1000, 0.5), 0.5);
  const double scale = coarsest_fallback(jump, 8000, 0.5);
  EXPECT_NEAR(8000 * scale * scale, 800, 1e-9);
  EXPECT_EQ(coarsest_fallback(jump, 1e6, 0.5), 0.25);
}

}  // namespace
}  // namespace rilievo

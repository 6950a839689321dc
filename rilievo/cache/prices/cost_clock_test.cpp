#include "rilievo/cache/prices/cost_clock.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

// A planner that captures what costs `cost` in frames whose budget of 8 ms suffices; `busy` frames
// take five times as long. Returns how many of the last 200 frames captured.
int captured_after(int busy, double cost) {
  constexpr double kMs = 2e-4, kBudgetMs = 8, kDrawn = 1e5;
  constexpr int kFrames = 600;
  CostClock clock(kMs);
  CacheOptions original, options;
  int captured = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const double times = frame < busy ? 5 : 1;
    clock.pass_frame();
    clock.set_budget(kBudgetMs, original, options);
    clock.drawing.learn(kDrawn, times * kMs * kDrawn);
    if (cost > options.capture_cost) continue;
    clock.capture.learn(cost, times * kMs * cost);
    captured += frame >= kFrames - 200;
  }
  return captured;
}

// After a busy moment the price of captures exceeds the budget, so that none is measured.
TEST(CostClock, CapturesBeginAgainAfterTheMachineWasBusy) {
  for (const int busy : {0, 1, 4, 10, 60}) EXPECT_EQ(captured_after(busy, 3e4), 200) << busy;
}

TEST(CostClock, WhatIsTooDearIsNotCaptured) {
  for (const int busy : {0, 10}) EXPECT_EQ(captured_after(busy, 5e4), 0) << busy;
}

TEST(CostClock, APriceThatIsMeasuredIsNotForgotten) {
  MeasuredPrice price{1e-3};
  for (int i = 0; i < 100; ++i) {
    price.learn(1e4, 10);
    price.pass_frame(1e-4);
  }
  EXPECT_DOUBLE_EQ(price.ms_per_cost, 1e-3);
  for (int i = 0; i < 400; ++i) price.pass_frame(1e-4);
  EXPECT_NEAR(price.ms_per_cost, 1e-4, 2e-6);
}

}  // namespace
}  // namespace rilievo

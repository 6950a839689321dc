// The time of a frame, by what the last ones took.
//
// Prices are in milliseconds per cost, as the CostModel estimates it. A price follows a dearer
// measurement at once by half, and a cheaper one slowly, so that budgets hold when the machine is
// busy. Drawing is measured in every frame. What is too dear for the budget is not done, so that
// nothing would say that the machine is no longer busy: a price that no frame measures goes down to
// that of drawing, slowly.
#pragma once

#include "rilievo/cache/plan/policy.h"

namespace rilievo {

// A price, measured.
struct MeasuredPrice {
  double ms_per_cost = 0;
  bool learned = false;  // since the last frame

  // Learns that work of this cost took `ms`.
  void learn(double cost, double ms);
  // A frame has passed: goes down to `least`, unless something was learned since the last one.
  void pass_frame(double least);
};

// The prices of drawing, of captures, and of fallbacks by rays.
struct CostClock {
  MeasuredPrice drawing, capture, fallback;

  // Starts with what the CostModel's machine takes; by default, two cores that take 220 ns for a
  // triangle.
  explicit CostClock(double ms_per_cost = 2.2e-4)
      : drawing{ms_per_cost},
        capture{ms_per_cost},
        fallback{ms_per_cost},
        modelled_ms_per_cost_(ms_per_cost) {}

  // Before each frame.
  void pass_frame();
  // Gives `options` a budget of `ms` milliseconds for captures, and the same for a fallback;
  // `original`: the same options without a budget. Fallbacks are priced in units of drawing, and
  // no picture of several objects costs more than half of the budget by its triangles alone. Where
  // drawing takes longer than the CostModel says, the first frame after a jump may cost less.
  void set_budget(double ms, const CacheOptions& original, CacheOptions& options) const;

 private:
  double modelled_ms_per_cost_;
};

}  // namespace rilievo

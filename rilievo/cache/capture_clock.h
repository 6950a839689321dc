// How long will captures take, by what they took?
//
// Prices are in milliseconds per cost, as the CostModel estimates it. A price follows a dearer
// measurement at once by half, and a cheaper one slowly, so that budgets hold when the machine is
// busy. Start with what was measured on two cores.
#pragma once

#include "rilievo/cache/policy.h"

namespace rilievo {

// A price, measured.
struct CapturePrice {
  double ms_per_cost = 0;

  // Learns that captures of this cost together took `ms`.
  void learn(double cost, double ms);
};

// The prices of captures, and of fallbacks by rays.
struct CaptureClock {
  CapturePrice capture{2.2e-4}, fallback{2.2e-4};

  // Gives `options` a budget of `ms` milliseconds; `original`: the same options without a budget.
  // Fallbacks are priced in units of captures, and no picture of several objects costs more than
  // half of the budget by its triangles alone.
  void set_budget(double ms, const CacheOptions& original, CacheOptions& options) const;
};

}  // namespace rilievo

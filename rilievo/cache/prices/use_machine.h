// Puts a machine's costs (machine_costs.h) in the place of the built-in prices of the planner.
#pragma once

#include "rilievo/cache/plan/policy.h"
#include "rilievo/cache/prices/cost_clock.h"
#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/nailboard/nailboard_store.h"

namespace rilievo {

// Does the machine's file hold what a cache needs that draws and captures so? The error says what
// is missing.
[[nodiscard]] Result<> expect_costs(const MachineCosts& costs, DrawnBy drawn_by, bool rasterizes);

// Replaces the prices of `options` by the machine's, and its budgets of triangles by those that
// take as long as the built-in ones on their machine. `clock` starts at the machine's prices.
// Requires expect_costs().
void use_machine(const MachineCosts& costs, DrawnBy drawn_by, bool rasterizes,
                 CacheOptions& options, CostClock& clock);

// The cost of drawing a kind's instance under `model`, whose triangles can be cheap or dear: work
// follows the cost of a picture's pixel; triangles are triangles. `triangles` of the result is 0.
[[nodiscard]] CostTerms terms_for(const CostTerms& terms, const CostModel& model);

}  // namespace rilievo

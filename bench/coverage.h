// How much of an object do its pictures hold? (S2.1, S2.2; figures 2 and 5)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// The share of the surface that is visible from outside and sampled: by one back-perspective
// picture against one ordinary picture (the mean over 32 directions), and by 12, 20 and 32
// back-perspective ones. Six objects; figures covered_OBJECT_back_1, _ordinary_1, _12, _20, _32,
// and _seen_32 with every point counted as often as it is seen.
[[nodiscard]] Result<BenchReport> coverage(const BenchOptions& options);

}  // namespace rilievo::bench

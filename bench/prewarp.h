// What does the pre-warp of layered reliefs cost? (S4.6 to S4.8; issue: 300 M samples a second)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> prewarp(const BenchOptions& options);

}  // namespace rilievo::bench

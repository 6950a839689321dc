// Which splats show a layered picture best, and fastest? (S4.9: figure 6)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> splats(const BenchOptions& options);

}  // namespace rilievo::bench

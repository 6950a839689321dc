// What do relief impostors cost, and what do they look like? (S5.2, S5.9)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> relief(const BenchOptions& options);

}  // namespace rilievo::bench

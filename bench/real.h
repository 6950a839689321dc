// Scenes such as users have, the eye moving by the clock: the cache against every baseline.
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> real(const BenchOptions& options);

}  // namespace rilievo::bench

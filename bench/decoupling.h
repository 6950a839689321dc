// Do frames stay fast and right while what they show takes long to shade? (S5.1, S5.7)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> decoupling(const BenchOptions& options);

}  // namespace rilievo::bench

// Does a walk go on while another program renders its pictures? (S5.8)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> program_walk(const BenchOptions& options);

}  // namespace rilievo::bench

// What do layered reliefs cost over a run of turns, as the paper measured them? (S4.4, S4.7)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> relief_run(const BenchOptions& options);

}  // namespace rilievo::bench

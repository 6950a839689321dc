// One walk around an object that is shown by relief impostors alone (S5.9).
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Appends a table and figures to the report.
[[nodiscard]] Result<> relief_walk(const BenchOptions& options, BenchReport& report);

}  // namespace rilievo::bench

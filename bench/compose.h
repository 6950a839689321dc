// How fast are nailboards drawn without OpenGL?
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Compares with OpenGL if there is one; needs none.
[[nodiscard]] Result<BenchReport> compose(const BenchOptions& options);

}  // namespace rilievo::bench

// How many nailboards can be drawn in a millisecond, and what does one cost against a plain
// textured quad that fetches as many texels?
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> draw(const BenchOptions& options);

}  // namespace rilievo::bench

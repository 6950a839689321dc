// What does it cost to capture a picture: by OpenGL, by the rasteriser made for pictures, by rays?
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> capture(const BenchOptions& options);

}  // namespace rilievo::bench

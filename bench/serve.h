// What a client of a live walk sees, and what it costs, over networks of all kinds.
//
// One server and its clients in simulated time (rilievo/serve/live_simulation.h), beside JPEG
// video, the warp of one plane and the warp of one keyframe. And the depth codec beside others.
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// As `rilievo bench serve` reports it. No OpenGL.
[[nodiscard]] Result<BenchReport> serve(const BenchOptions& options);

}  // namespace rilievo::bench

// What do layered reliefs gain for deep objects near the eye, where flat pictures last two frames?
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Needs RILIEVO_DATA in the environment: a folder with obj/copperBeech and models/FlightHelmet.
[[nodiscard]] Result<BenchReport> deep_objects(const BenchOptions& options);

}  // namespace rilievo::bench

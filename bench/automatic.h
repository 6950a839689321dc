// Does the method `auto` take as little time as the best of all methods?
//
// Along walks through the scenes of bench/real_scenes.h, through built-in scenes, or through files
// with paths beside them. All methods draw the same frames in turn, so that each meets the same
// load.
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// As `rilievo bench auto` reports it. No OpenGL.
[[nodiscard]] Result<BenchReport> automatic(const BenchOptions& options);

}  // namespace rilievo::bench

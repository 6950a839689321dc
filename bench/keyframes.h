// What do whole frames from keyframes cost, and what do they look like, beside direct drawing?
//
// Walks in real time through the scenes of bench/real_scenes.h, or through files with paths beside
// them. Colours are compared with true frames of many samples a pixel, direct drawing's too.
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// As `rilievo bench keyframes` reports it. No OpenGL.
[[nodiscard]] Result<BenchReport> keyframes(const BenchOptions& options);

}  // namespace rilievo::bench

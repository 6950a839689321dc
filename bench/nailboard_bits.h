// How many bits of Delta does a nailboard need? (S1.4, figure 5 of [Schaufler 1997])
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Touching and interpenetrating objects, each a nailboard captured from the very eye that sees the
// frame, so that what is wrong is wrong for want of bits. Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> nailboard_bits(const BenchOptions& options);

}  // namespace rilievo::bench

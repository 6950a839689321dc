// Does a picture that replaces another one pop, and does fading help? (S1.5)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// How much more than the true frames the cache's frames differ from those before them, with and
// without the cross-fade: figures pop_max_faded, pop_max_unfaded and pop_ratio, the first over the
// second. Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> pop(const BenchOptions& options);

}  // namespace rilievo::bench

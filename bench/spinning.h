// What does a cache gain from layered impostors that were baked before? (S1.7, S2)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Heavy teapots that spin about themselves, so fast that no flat picture lasts: drawn directly, by
// a cache, and by caches that may draw impostors, as walks or as slices. Figures: frame_ms_p50_*,
// psnr_db_*, bound_px_max_*, layered_share_*, for direct, cache, walk, slices. Needs a current
// OpenGL context.
[[nodiscard]] Result<BenchReport> spinning(const BenchOptions& options);

}  // namespace rilievo::bench

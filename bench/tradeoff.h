#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// A walk through a forest of ten million triangles for allowed errors of 0.25, 0.5, 1 and 2 pixels:
// figures speedup_Epx, psnr_db_Epx, ssim_Epx, flip_Epx, frame_ms_p50_Epx, frame_ms_p99_Epx,
// bound_px_max_Epx, and direct_ms_p50, embree_ms.
[[nodiscard]] Result<BenchReport> tradeoff(const BenchOptions& options);

// The cached walk's p50 from 10^5 to 10^8 triangles of the same forest, seen from the same path, by
// software and, if there is one, by OpenGL: figures software_ms_p50_N, software_busy_ms_p50_N (of
// processors), frame_ms_p50_N; software_growth_ratio, software_busy_growth_ratio and growth_ratio,
// the last over the first.
[[nodiscard]] Result<BenchReport> scaling(const BenchOptions& options);

}  // namespace rilievo::bench

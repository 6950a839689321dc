// What do layered impostors cost? (S2.5, S2.8; tables 2 and 3, figure 8)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Memory against the paper's tables; slices left after empty ones are dropped and what their
// rectangles save; what filling holes adds; time per draw over on-screen size for 64, 128 and 256
// layers against triangles drawn directly. Figures memory_mb_VIEWS_SIZE, draw_ms_LAYERS_220,
// break_even_triangles_LAYERS_220 and so on. Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> layered_cost(const BenchOptions& options);

}  // namespace rilievo::bench

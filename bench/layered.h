// Layered impostors seen from new eyes (S2.3 to S2.6).
#pragma once

#include "bench/bench.h"
#include "bench/objects.h"

namespace rilievo::bench {

// Quality of the teapot over seeded random eyes for views {12, 20, 32} x size {64, 128, 256} x
// layers {16, 64, 256}, with and without hole filling, drawn as slices; the same of the walk
// through the surfaces; the six objects at one setting; tears; how far views that switch jump.
// Figures psnr_db_OBJECT_VIEWS_SIZE_LAYERS, uncovered_... and so on (with hole filling;
// ..._unfilled without; ..._VIEWS_SIZE_surfaces for the walk), tears_..._at_20deg, jump_....
//
// The parts of the bench, which add to its report. They need a current OpenGL context.
[[nodiscard]] Result<> add_quality(const BenchOptions& options, BenchReport& report);
[[nodiscard]] Result<> add_tears(const BenchOptions& options, BenchReport& report);
[[nodiscard]] Result<> add_jumps(const BenchOptions& options, BenchReport& report);

}  // namespace rilievo::bench

// What do environment nodes look like from their own eyes and between them, and what do they cost?
// (S3.1 to S3.9)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> nodes(const BenchOptions& options);

// Does a node's bound hold for what is drawn, and how tight is it? Needs a current OpenGL context.
[[nodiscard]] Result<BenchReport> node_bound(const BenchOptions& options);

// How many nodes hold what can be seen, placed by worth and on a grid?
[[nodiscard]] Result<BenchReport> node_places(const BenchOptions& options);

}  // namespace rilievo::bench

// How well do few triangles stand for a node's depths, against a regular grid and against a full
// grid that a mesh simplifier has made smaller; and how fast? (S3.2)
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

// Needs no OpenGL.
[[nodiscard]] Result<BenchReport> triangulate_nodes(const BenchOptions& options);

}  // namespace rilievo::bench

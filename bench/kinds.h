// How fast is each baked kind drawn without OpenGL, against OpenGL and against polygons?
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> kinds_without_opengl(const BenchOptions& options);

}  // namespace rilievo::bench

// The benches, each in the file of its name: its opening comment says what it measures.
#pragma once

#include "bench/bench.h"

namespace rilievo::bench {

[[nodiscard]] Result<BenchReport> automatic(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> bound(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> capture(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> compose(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> coverage(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> decoupling(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> deep_objects(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> draw(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> jumps(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> keyframes(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> kinds_without_opengl(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> layered(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> layered_cost(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> nailboard_bits(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> nailboard_error(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> node_bound(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> node_places(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> nodes(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> pop(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> prewarp(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> program_walk(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> real(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> relief(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> relief_run(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> rgbd(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> scaling(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> serve(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> slow_keyframes(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> spinning(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> splats(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> tradeoff(const BenchOptions& options);
[[nodiscard]] Result<BenchReport> triangulate_nodes(const BenchOptions& options);

}  // namespace rilievo::bench

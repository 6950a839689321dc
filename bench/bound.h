// bound_error() against the truth: whether it holds, and how much larger it is.
//
// Random eyes and poses around objects with known surfaces: what the capture eye sees of them is
// sampled by ray casting, drawn on the flat rectangle and projected from the new eye in doubles;
// the farthest any sample lies from where it belongs is the measured error. No OpenGL.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rilievo::bench {

struct BoundOptions {
  int cases = 10000;
  std::uint64_t seed = 1;
  double scale = 1;  // of the bound: 0.5 must make violations, or the comparison proves nothing
};

struct BoundStats {
  int cases = 0;
  int violations = 0;           // measured error above the scaled bound
  double tightness_median = 0;  // bound / measured, where measured > 0.25 px
  struct OfObject {
    std::string name;
    int cases = 0, violations = 0;
    double tightness_median = 0;
  };
  std::vector<OfObject> objects;
};

// The same figures for the same options, everywhere.
[[nodiscard]] BoundStats run_bound_benchmark(const BoundOptions& options);

}  // namespace rilievo::bench

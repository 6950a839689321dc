// bound_gap_px() against the truth: whether it holds, and how much larger it is.
//
// Random eyes around scenes that hide things: what the frame's eye sees and the capture's did not
// is found by ray casting, and measured along epipolar lines. No OpenGL.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rilievo::bench {

struct GapOptions {
  int cases = 10000;
  std::uint64_t seed = 1;
  double scale = 1;  // of the bound: 0.5 must make violations, or the comparison proves nothing
};

struct GapStats {
  int cases = 0;
  int violations = 0;           // a strip wider than the scaled bound and kGapMeasuredTo
  double worst_excess_px = 0;   // of those
  double tightness_median = 0;  // bound / truth where the truth is at least a pixel
  int seen = 0;                 // cases whose truth is at least a pixel
  // The share of them that the bound of what the capture saw (PictureError::disocclusion_px)
  // misses.
  int slab_violations = 0;
  struct OfScene {
    std::string name;
    int cases = 0, seen = 0, violations = 0, slab_violations = 0;
    double tightness_median = 0;
  };
  std::vector<OfScene> scenes;
};

inline constexpr double kGapMeasuredTo = 0.1;  // pixels: two steps along an epipolar line

// The same figures for the same options, everywhere.
[[nodiscard]] GapStats run_gap_benchmark(const GapOptions& options);

}  // namespace rilievo::bench

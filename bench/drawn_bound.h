// Do the bounds of pictures hold for what is drawn? (S1.5)
//
// bound.h checks the formula. Here the cache draws whole frames with OpenGL: captures, narrowed
// slabs, cross-fades, anticipation, objects that move, cuts; and each ball of a cloud of them is
// looked for in the frame's identifiers. Its centroid and its outline are compared with the true
// frame's. Needs a current OpenGL context.
#pragma once

#include <cstdint>
#include <functional>

#include "rilievo/core/result.h"

namespace rilievo::bench {

// By how much more than the bound a ball's outline may be off. Identifiers are taken at the centres
// of texels, `texel_px` pixels wide, which puts a point off by half a diagonal, and of pixels: the
// nearest of these within a ball is up to sqrt(1 + 1/4) pixels from a point of its edge. A tenth of
// a pixel more, because the ball itself is of facets.
[[nodiscard]] inline double outline_slack_px(double texel_px) {
  return 0.1 + 1.11804 + 0.70711 * texel_px;
}
// And its centroid: where texels are as large as pixels and lie between them, each pixel takes its
// identifier from the same side, by up to half of a texel's diagonal. What is left of the rest in
// the mean over an outline of twenty pixels or more is below a tenth of a pixel.
[[nodiscard]] inline double centroid_slack_px(double texel_px) { return 0.1 + 0.70711 * texel_px; }

struct DrawnBoundOptions {
  int cases = 10000;    // balls seen in frames, at least
  double error_px = 1;  // of the cache
  std::uint64_t seed = 1;
  double scale =
      1;  // of the bound: a quarter must make violations, or the comparison proves nothing
  std::function<void(int done, int of)> progress;
};

struct DrawnBoundStats {
  int cases = 0, frames = 0, captures = 0;
  double unseen_px_max = 0;  // the widest strip of a ball's far side that its picture lacks
  int fading = 0;            // cases of which two pictures are shown
  int moving = 0;            // cases of balls that move
  int missing = 0;           // balls without a pixel
  int violations = 0;        // missing, or farther off than the scaled bound and its slack
  double centroid_excess_px = 0, outline_excess_px = 0;  // over the bound, most; may be negative
  double bound_px_max = 0;
  double tightness_median = 0;  // bound / error of the centroid where that is above half a pixel
};

// The same figures for the same options on the same machine.
[[nodiscard]] Result<DrawnBoundStats> run_drawn_bound_benchmark(const DrawnBoundOptions& options);

}  // namespace rilievo::bench

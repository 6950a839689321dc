// The error of a pre-warped relief by its definition: how far from its true place a sample is
// shown, at most, in pixels of a frame. relief_bound.h bounds it by plain data.
//
// For frames with the eye that the relief was warped for. A source texel shows one surface point
// everywhere (half a diagonal). Its depth is that of a sample that others were merged into, and is
// rounded. The result has texels of its own (half a diagonal). Cracks are not position errors and
// are not bounded.
//
// In metres, and then as angles: what is off by e at a distance r, at right angles to the line of
// sight, is off by at most e / r / cos^2 focal lengths in the frame, cos being that of the angle
// between the line of sight and the frame's axis.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/layered_relief/prewarp.h"

namespace rilievo {

// How the relief was made and warped.
struct ReliefErrorOptions {
  double splat_size = 1.0;
  double resolution = 1.0;  // of the result
  // The error that the samples had before, metres: that of resampled deep images.
  double source_error = 0.0;
};

// An upper bound of the error of each sample shown; infinite if the relief cannot be warped for the
// camera's eye. Requires a perspective camera.
[[nodiscard]] inline double relief_error_px(const LayeredRelief& relief, const Camera& camera,
                                            const ReliefErrorOptions& options = {}) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective && !relief.perspective());
  const ReliefFrame frame = relief.frame();
  const auto warp = relief_warp(frame, camera.position());
  const auto rectangle = warp ? relief_rectangle(relief, *warp, options.splat_size) : std::nullopt;
  if (!rectangle) return std::numeric_limits<double>::infinity();
  const double diagonal = std::hypot(glm::length(frame.a), glm::length(frame.b));
  const double h = 1 / warp->k3;

  // The steepest line of sight to anything in the rectangle, against the relief's direction.
  double most_tangent = 0;
  for (const double x : {rectangle->min.x, rectangle->max.x})
    for (const double y : {rectangle->min.y, rectangle->max.y}) {
      const glm::dvec2 from = glm::dvec2(x, y) - warp->epipole();
      most_tangent = std::max(most_tangent, glm::length(from.x * frame.a + from.y * frame.b) / h);
    }
  const double sine = most_tangent / std::sqrt(1 + most_tangent * most_tangent);

  // Nearest to the eye, everything is largest: distances are at least those along the direction.
  const double nearest = h + relief.nearest_d();
  const double depth = relief.merged_d + 0.5 * relief.d_step + options.source_error;
  const double sample =
      0.5 * std::max(1.0, options.splat_size) * diagonal + depth * sine + options.source_error;
  const double texel = 0.5 * diagonal / options.resolution;
  const double angle = sample / nearest + texel / h;

  const auto& [l, r, b, t] = camera.window;
  const double x = std::max(std::abs(l), std::abs(r)), y = std::max(std::abs(b), std::abs(t));
  const double focal = std::max(camera.width / (r - l), camera.height / (t - b));
  return focal * angle * (1 + x * x + y * y);
}

}  // namespace rilievo

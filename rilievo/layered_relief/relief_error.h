// How far from its true place can a pre-warped relief show a sample? In pixels of a frame.
//
// For frames with the eye that the relief was warped for. A source texel shows one surface point
// everywhere (half a diagonal). Its depth is that of a sample that others were merged into, and is
// rounded. The result has texels of its own (half a diagonal), and kept tiles are off by up to
// reuse_error. Cracks are not position errors and are not bounded.
#pragma once

#include "rilievo/layered_relief/prewarp.h"

namespace rilievo {

// How the relief was made and warped.
struct ReliefErrorOptions {
  double splat_size = 1.0;
  double resolution = 1.0;   // of the result
  double reuse_error = 0.0;  // texels of the result
  // The error that the samples had before, metres: that of resampled deep images.
  double source_error = 0.0;
};

// An upper bound of the error of each sample shown; infinite if the relief cannot be warped for the
// camera's eye. Requires a perspective camera.
[[nodiscard]] double relief_error_px(const LayeredRelief& relief, const Camera& camera,
                                     const ReliefErrorOptions& options = {});

}  // namespace rilievo

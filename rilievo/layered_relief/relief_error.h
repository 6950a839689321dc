// How far from where it belongs may a pre-warped relief show a sample? In pixels of a frame.
//
// For frames whose eye the relief was warped for. A texel of the source shows one point of its
// surface all over (half a diagonal); its depth is that of a sample that others were merged into,
// and rounded; the result has texels of its own (half a diagonal), and so have tiles that were not
// warped again. Cracks are not errors of position, and not bounded.
#pragma once

#include "rilievo/layered_relief/prewarp.h"

namespace rilievo {

struct ReliefErrorOptions {
  double splat_size = 1.0;
  double resolution = 1.0;   // of the result
  double reuse_error = 0.0;  // texels of the result
  // What the samples were already off when they came, metres: those of resampled deep images.
  double source_error = 0.0;
};

// Never less than the error of any sample shown; infinite if the relief cannot be warped for the
// camera's eye. Requires a perspective camera.
[[nodiscard]] double relief_error_px(const LayeredRelief& relief, const Camera& camera,
                                     const ReliefErrorOptions& options = {});

}  // namespace rilievo

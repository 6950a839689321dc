// A layered picture in perspective as one in parallel projection (S4.1).
//
// Deep images are mostly perspective, and a relief is parallel. A perspective sample stands for a
// small square across its line of sight; it becomes a sample of every parallel line of sight that
// meets the square, or of the nearest one if none does.
#pragma once

#include "rilievo/core/depth_image.h"

namespace rilievo {

struct ResampleOptions {
  int size = 512;  // texels of the longer side; texels are square
  // Only samples that begin in front of this eye_z; what is far away is as large as it is vague.
  double max_z = 1e30;
};

struct ResampledLayers {
  LayeredDepthImage layers;  // eye_z
  // No sample stands farther than this from where its surface was seen, across the line of sight;
  // metres. Part of the bound (ReliefErrorOptions::source_error).
  double error = 0;
};

// Looks the same way as the camera of `layers`, through a window around all samples. Requires a
// valid perspective picture; an empty one is an error.
[[nodiscard]] Result<ResampledLayers> resample_layers(const LayeredDepthImage& layers,
                                                      const ResampleOptions& options = {});

}  // namespace rilievo

// How does a layered picture in perspective become one in parallel projection? (S4.1)
//
// Most deep images are in perspective; a relief is parallel. A perspective sample stands for a
// small square across its line of sight. It becomes a sample of every parallel line of sight that
// meets the square, or of the nearest one if none does.
#pragma once

#include <cstddef>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// The resolution and the range.
struct ResampleOptions {
  int size = 512;  // texels of the longer side; texels are square
  // Samples that begin beyond this eye_z are dropped: distant samples stand for large, coarse
  // squares.
  double max_z = 1e30;
  // A result of more samples is an error. So many take 4 GB, and 8 GB while they are made.
  std::size_t max_samples = std::size_t(1) << 27;
};

// The result and its error.
struct ResampledLayers {
  LayeredDepthImage layers;  // of eye_z
  // The largest distance of a sample from the place where its surface was seen, across the line of
  // sight; metres. Part of the bound (ReliefErrorOptions::source_error).
  double error = 0;
};

// The new camera looks in the same direction as that of `layers`, through a window around all
// samples. Requires a valid perspective picture. Fails if it is empty or becomes too many samples.
[[nodiscard]] Result<ResampledLayers> resample_layers(const LayeredDepthImage& layers,
                                                      const ResampleOptions& options = {});

}  // namespace rilievo

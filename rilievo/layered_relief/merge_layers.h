// How does a layered depth image look the same with fewer samples?
#pragma once

#include "rilievo/core/depth_image.h"

namespace rilievo {

// Merges the samples of each line of sight that lie at most `tolerance` behind the first of them;
// the first is kept. Depths are of the picture's own kind.
[[nodiscard]] LayeredDepthImage merge_layers(const LayeredDepthImage& layers, double tolerance);

// For renderers that draw a sample completely or not at all: gathers the translucent samples of
// each line of sight, nearest first, into one until their opacity reaches `least_alpha`. It has
// their composited colour at full opacity and the depth of the sample that contributes most. A
// remainder with less opacity is dropped.
[[nodiscard]] LayeredDepthImage gather_layers(const LayeredDepthImage& layers, float least_alpha);

}  // namespace rilievo

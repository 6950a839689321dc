// Layered depth images with fewer samples that look the same.
#pragma once

#include "rilievo/core/depth_image.h"

namespace rilievo {

// Of samples along one line of sight of which each lies at most `tolerance` behind the first, the
// first is kept. Depths are of the picture's own kind.
[[nodiscard]] LayeredDepthImage merge_layers(const LayeredDepthImage& layers, double tolerance);

// For whoever draws a sample or does not: each line of sight's translucent samples, nearest first,
// are gathered into one until together they hide `least_alpha` of what is behind. It has the colour
// of them all, unweakened, and the depth of the one that contributes most. What is left at the end
// and hides less is dropped.
[[nodiscard]] LayeredDepthImage gather_layers(const LayeredDepthImage& layers, float least_alpha);

}  // namespace rilievo

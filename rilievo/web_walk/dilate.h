// Colours past silhouettes: what shows nothing takes the colours beside it, so that neither
// interpolation nor compression lets something else bleed into edges.
#pragma once

#include "rilievo/core/color.h"

namespace rilievo {

// Gives texels of alpha 0 the mean colour of their neighbours, ring by ring, and those far from
// everything the mean of all. Alpha stays.
void dilate_colors(Rgba8Image& picture);

}  // namespace rilievo

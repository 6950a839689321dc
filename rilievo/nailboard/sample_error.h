// How far from where they belong does a frame show a picture's samples?
//
// What bound_error() bounds from above, measured sample by sample: the slow truth that bounds are
// tested against and that reports give.
#pragma once

#include <vector>

#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

// Appends, for every `step`-th covered texel in x and y, the distance in pixels between where the
// polygon puts it and where the surface point that it shows projects to, if either of the two lies
// in the frame; infinite if one of them is in the frame and the other nearer than its near plane.
// The point's depth is Delta's, which is within half a step, 1 / (2^(bits+1) - 4) of the picture's
// slab. `frame` is relative to the object as captured: for an object that has moved since, its
// camera moved against it.
void append_sample_errors(const Nailboard& picture, const Camera& frame, int step,
                          std::vector<float>& errors_px);

}  // namespace rilievo

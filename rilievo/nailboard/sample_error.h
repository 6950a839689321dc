// How far from their true places does a frame show a picture's samples?
//
// Measures sample by sample what bound_error() bounds from above; slow. Tests compare bounds with
// it, and reports contain it.
#pragma once

#include <vector>

#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

// For every `step`-th covered texel in x and y, appends the distance in pixels between where the
// polygon shows it and where its surface point projects, if either lies in the frame. Infinite if
// one lies in the frame and the other is nearer than its near plane. The point's depth is decoded
// from Delta, whose error is half a step, 1 / (2^(bits+1) - 4) of the picture's slab. For an object
// that has moved since the capture, move `frame`'s camera the opposite way.
void append_sample_errors(const Nailboard& picture, const Camera& frame, int step,
                          std::vector<float>& errors_px);

}  // namespace rilievo

// How wide is what a frame lacks?
//
// Where a surface was hidden when a picture was captured, the picture lacks a strip of it, and the
// frame shows something behind the surface instead. Compares a frame with the true frame of the
// same size; eye_z in metres, beyond all numbers where nothing is seen.
#pragma once

#include "rilievo/core/image.h"
#include "rilievo/measure/visibility.h"

namespace rilievo {

// The width of the widest gap, in pixels; 0: none.
//
// A pixel lacks its surface if the true frame shows an object there and the frame something behind
// it: farther by more than 1 % than anything that the true frame shows of this object in the 3 x 3
// neighbourhood, so that a slanted surface that is a pixel off its place is no gap. A pixel's width
// is the length of the shortest of four runs of such pixels through it: along the row, the column
// and the two diagonals (sqrt(2) a pixel). The width of a straight strip in any direction is met
// within 9 % and a pixel: 1 / cos(22.5 degrees) is 1.08. An error of position of e pixels looks
// like a gap as wide as that beside each edge.
[[nodiscard]] double widest_gap_px(const IdImage& true_ids, const Image<float>& true_eye_z,
                                   const Image<float>& eye_z);

}  // namespace rilievo

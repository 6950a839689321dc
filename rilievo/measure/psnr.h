// PSNR: the difference between two frames, pixel by pixel.
//
// The peak signal-to-noise ratio of 8-bit sRGB frames over R, G and B together; alpha is ignored.
// Sums are exact integers: the result does not depend on the number of threads.
#pragma once

#include "rilievo/core/color.h"

namespace rilievo {

// 10 log10(255^2 / mean squared difference) in dB; +infinity if the frames are the same. Requires
// two frames of one size, of at least one pixel.
[[nodiscard]] double psnr_db(const Rgba8Image& a, const Rgba8Image& b);

}  // namespace rilievo

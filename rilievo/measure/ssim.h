// SSIM: the similarity of the structure of two frames.
//
// [Wang, Bovik, Sheikh, Simoncelli 2004], "Image quality assessment: from error visibility to
// structural similarity": a Gaussian window of 11 x 11 pixels with sigma 1.5, K1 = 0.01,
// K2 = 0.03, over the luma (0.299 R + 0.587 G + 0.114 B) of 8-bit sRGB frames, averaged over the
// windows that lie inside the frame. That is scikit-image's structural_similarity with
// gaussian_weights, sigma=1.5, use_sample_covariance=False, data_range=255.
//
// Rows run in parallel; the result does not depend on the number of threads.
#pragma once

#include "rilievo/core/color.h"

namespace rilievo {

inline constexpr int kSsimWindow = 11;  // pixels a side

// Mean structural similarity, from -1 to 1; 1 if the frames are equal. Requires two frames of one
// size, at least
// kSsimWindow pixels wide and high.
[[nodiscard]] double ssim(const Rgba8Image& a, const Rgba8Image& b);

}  // namespace rilievo

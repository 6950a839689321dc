// The filters of FLIP, as products of filters along rows and along columns.
#pragma once

#include <vector>

namespace rilievo {

// Of odd length, centred.
using FlipKernel = std::vector<float>;

struct FlipKernels {
  // Contrast sensitivity; each sums to 1, the two of blue-yellow together.
  FlipKernel achromatic, red_green;
  FlipKernel blue_yellow[2];  // along rows; their weights are in them
  FlipKernel blue_yellow_down[2];
  // A Gaussian, its slope, and its curvature: the positive weights of the latter two sum to 1, the
  // negative ones to -1.
  FlipKernel smooth, slope, curve;
  int radius = 0;  // of the longest
};

[[nodiscard]] FlipKernels make_flip_kernels(double pixels_per_degree);

}  // namespace rilievo

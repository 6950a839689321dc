// Which filters does FLIP use? Separable ones: products of a filter along rows and one along
// columns.
#pragma once

#include <vector>

namespace rilievo {

// The weights of a centred filter of odd length.
using FlipKernel = std::vector<float>;

// All filters of FLIP at one resolution.
struct FlipKernels {
  // Contrast sensitivity of the opponent channels. Each sums to 1; the two of blue-yellow do
  // together.
  FlipKernel achromatic, red_green;
  FlipKernel blue_yellow[2];  // along rows; includes the weights of the two terms
  FlipKernel blue_yellow_down[2];
  // A Gaussian, its first and its second derivative. In both derivatives, the positive weights sum
  // to 1 and the negative ones to -1.
  FlipKernel smooth, slope, curve;
  int radius = 0;  // of the longest filter, pixels
};

// The filters for a screen of `pixels_per_degree`.
[[nodiscard]] FlipKernels make_flip_kernels(double pixels_per_degree);

}  // namespace rilievo

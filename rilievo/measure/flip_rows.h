// What are the inner loops of FLIP? Rows of pixels, filtered and compared.
//
// Internal to the folder. SIMD, chosen at run time. No multiplication is fused with an addition, so
// that all instruction sets give the same bytes. Planes of a row lie `pitch` floats apart; counts
// and pitches are multiples of kFlipLanes.
#pragma once

#include <array>

#include "rilievo/core/color.h"
#include "rilievo/measure/flip_kernels.h"

namespace rilievo {

// Pixels that are computed at once, at most.
inline constexpr int kFlipLanes = 16;
// `count`, rounded up to whole vectors.
inline constexpr int flip_padded(int count) {
  return (count + kFlipLanes - 1) / kFlipLanes * kFlipLanes;
}

// Planes of a row that is filtered both ways.
enum FlipFiltered { kYOut, kCxOut, kCzOut, kEdgeX, kEdgeY, kPointX, kPointY, kFlipFiltered };
// Planes of what is compared.
enum FlipSeen { kLightness, kRed, kBlue, kEdge, kPoint, kFlipSeen };

// Between linear RGB and X Y Z over those of white. Columns.
struct FlipColors {
  glm::mat3 xyz_from_rgb, rgb_from_xyz;
};

// out[x] = sum of kernel[k] * in[k][x].
void flip_filter(const FlipKernel& kernel, const float* const* in, int count, float* out);

// L*, a* and b* under Hunt's adjustment, and the lengths of slope and curvature.
void flip_see(const FlipColors& colors, const float* filtered, int count, float* seen, int pitch);

// FLIP of two rows. `most`: the largest distance of two colours, to the power of 0.7.
void flip_compare(const float* truth, int truth_pitch, const float* frame, int frame_pitch,
                  float most, int count, float* out);
// HyAB distance of two colours to the power of 0.7.
float flip_distance(const glm::vec3& lab, const glm::vec3& other);

}  // namespace rilievo

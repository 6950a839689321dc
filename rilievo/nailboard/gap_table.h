// How wide a strip may a picture lack of what its own objects hid from the capturing eye?
//
// The capture knows, of each texel's ray, the nearest surface and the farthest of all, hidden ones
// included. What is hidden appears beside the edges of what hides it. How far beside is bounded by
// a pass over the texels, whose result is a table of 64 bytes: 8 octants of the direction in which
// the frame's eye has moved, 8 ratios of parallax to texels. A closed solid does not pay for its
// back, which falls away behind its outline; a plate before a bar does.
//
// Assumed: nothing stands between two neighbouring texels nearer or farther than what both show,
// and no slit. Where it is not so, what shows through a slit narrower than a texel may pass the
// bound, by less than one texel.
#pragma once

#include <array>
#include <cstdint>

#include "rilievo/core/image.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/nailboard/error.h"

namespace rilievo {

inline constexpr int kGapOctants = 8, kGapLevels = 8;

// In units of 1/eye_z: codes of [w_back, w_front] in 253 steps.
struct GapTable {
  double w_front = 0, w_back = 0;  // of all surfaces, hidden ones included; both 0: no surface
  // Octant bits: 1: x < 0; 2: y < 0; 4: |x| > |y|, of the direction in which edges move against
  // what is behind them, in raster space. Level j: parallax of 2^(j-1) texels between the ends.
  std::array<std::array<std::uint8_t, kGapLevels>, kGapOctants> code{};
};

// `nearest`, `farthest`: eye_z, or kNoDepth where a texel shows nothing; of one size. Where only
// one of them is kNoDepth, or farthest < nearest (rounding), the other is taken. About a
// millisecond for 256 x 256 texels on one core with AVX2. Any thread.
[[nodiscard]] GapTable make_gap_table(const Image<float>& nearest, const Image<float>& farthest);

// Where nothing is known but that all surfaces lie between the camera's z_near and z_far.
[[nodiscard]] GapTable unknown_gaps(const Camera& capture);

// Pixels of `frame`: every surface point of the picture's objects that the frame's eye sees inside
// the frame and that the capture did not see lies within so many pixels of the true position of an
// edge that the capture saw, if that edge is at most a frame's size outside the frame. Infinite
// where the eye is within the picture's depths, or the motion is not rigid. About a microsecond.
[[nodiscard]] double bound_gap_px(const PictureGeometry& picture, const GapTable& table,
                                  const Camera& frame, const RigidMotion& motion = {});

}  // namespace rilievo

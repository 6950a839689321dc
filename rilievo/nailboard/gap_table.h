// The width of the strip that a picture lacks because its own objects hid it at capture.
//
// For each texel's ray, the capture knows the nearest surface and the farthest of all surfaces,
// including hidden ones. Hidden surfaces appear beside the edges of the surfaces that hide them. A
// pass over the texels bounds their distance from the edge. Its result is a table of 64 bytes: 8
// octants of the direction in which the frame's eye has moved, times 8 ratios of parallax to
// texels. For a closed solid, the back does not count, because it falls away behind the outline;
// for a plate in front of a bar, the bar does.
//
// Assumption: between two neighbouring texels there is neither a surface nearer or farther than
// both show, nor a slit. Otherwise, what shows through a slit narrower than a texel can exceed the
// bound by less than one texel.
#pragma once

#include <array>
#include <cstdint>

#include "rilievo/core/image.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/nailboard/error.h"

namespace rilievo {

// The size of the table.
inline constexpr int kGapOctants = 8, kGapLevels = 8;

// The table of a picture, in units of 1/eye_z: codes of [w_back, w_front] in 253 steps.
struct GapTable {
  double w_front = 0, w_back = 0;  // of all surfaces, including hidden ones; both 0: none
  // Octant bits, for the direction in raster space in which edges move relative to what is behind
  // them: 1: x < 0; 2: y < 0; 4: |x| > |y|. Level j: a parallax of 2^(j-1) texels between the ends.
  std::array<std::array<std::uint8_t, kGapLevels>, kGapOctants> code{};
};

// Computes the table. `nearest` and `farthest` have one size and hold eye_z, or kNoDepth where a
// texel shows nothing. Where only one is kNoDepth, or farthest < nearest (rounding), the other one
// is used. About a millisecond for 256 x 256 texels on one core with AVX2. Any thread.
[[nodiscard]] GapTable make_gap_table(const Image<float>& nearest, const Image<float>& farthest);

// The table if nothing is known except that all surfaces lie between the camera's z_near and z_far.
[[nodiscard]] GapTable unknown_gaps(const Camera& capture);

// A bound in pixels of `frame`. Each surface point of the picture's objects that the frame's eye
// sees inside the frame, and that the capture did not see, lies within this distance of the true
// position of an edge that the capture saw, if that edge is at most a frame's size outside the
// frame. Infinite for an eye within the picture's depths and for a motion that is not rigid. About
// a microsecond.
[[nodiscard]] double bound_gap_px(const PictureGeometry& picture, const GapTable& table,
                                  const Camera& frame, const RigidMotion& motion = {});

}  // namespace rilievo

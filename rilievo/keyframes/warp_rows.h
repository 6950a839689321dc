// The SIMD passes of keyframes/warp_keyframes.h. Internal: not a stable interface.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rilievo/keyframes/warp_sources.h"

namespace rilievo {

// Depths of rows [first, first + rows) of a frame, with a border of one pixel on each side.
struct DepthStrip {
  static constexpr int kBorder = 16;  // columns: a row begins at a whole vector
  float* inverse_z = nullptr;         // of the row above the first one, at its border
  std::size_t stride = 0;
  int first = 0, rows = 0, width = 0;
  // Of each kPlainSkyColumns columns: a keyframe shows nothing but the sky there. Null: that is
  // not asked.
  const std::uint8_t* plain_sky = nullptr;

  [[nodiscard]] float* row(int y) const {
    return inverse_z + std::size_t(y - first + 1) * stride + kBorder;
  }
};

// Draws the squares of texels [from, to) of a row into the strip. Nothing nearer than 1 / near.
// `may_crack`: some of them may have a parallax of more than kCrackParallax.
void splat_row(const WarpSource& source, int y, int from, int to, float near, bool may_crack,
               const DepthStrip& out);

// The rows of the strip: depths and colours of row y. `cover`: 1 / eye_z of what will be drawn over
// the row's pixels; null: nothing will (WarpCover). Where plain_sky says so, and no square is or is
// beside it, a pixel is kPlainSky. Returns the number of holes.
std::uint32_t shade_row(const WarpSource* sources, int count, const DepthStrip& strip, int y,
                        const float* cover, float nearest_thing, float* inverse_z,
                        std::uint32_t* color);

}  // namespace rilievo

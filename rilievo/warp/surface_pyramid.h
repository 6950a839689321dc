// Over which squares of texels does a ray hit nothing?
//
// A pyramid over a picture's surface stores for each square of texels the depth range of its
// surface patches. A ray that stays in front of all of them, or behind all of them, skips the
// square, so that the cost of a ray depends on the surfaces that it passes closely, not on the
// number of texels under it. The march from texel to texel (texel_surface.h) defines the result.
//
// Values are sigma q, with sigma = +1 for ordinary pictures and -1 for back-perspective ones:
// larger is nearer to the picture's viewers. Pure.
#pragma once

#include <vector>

#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// A square of texels.
struct SurfaceCell {
  // The range of its patches; without patches, in front of nothing and behind nothing.
  float front = -1e30f, back = 1e30f;
  bool holes = false;  // contains texels without a patch
};

// All levels of squares.
struct SurfacePyramid {
  static constexpr int kBlock = 4;   // texels a side of a cell of the finest level
  static constexpr int kFactor = 4;  // cells a side of the next level's cell
  static constexpr int kLevels = 4;
  // levels[0] is the finest.
  std::vector<Image<SurfaceCell>> levels;
};

// Builds the pyramid of a surface.
[[nodiscard]] SurfacePyramid make_surface_pyramid(const TexelSurface& surface);

}  // namespace rilievo

// Over which squares of texels does a ray hit nothing?
//
// A pyramid over a picture's surface stores for each square of texels the depth range of its
// surface patches. A ray that stays in front of all of them, or behind all of them, skips the
// square, so that the cost of a ray depends on the surfaces that it passes closely, not on the
// number of texels under it. The result equals that of the march from texel to texel
// (texel_surface.h), which defines it.
//
// Values are sigma q, with sigma = +1 for ordinary pictures and -1 for back-perspective ones:
// larger is nearer to the picture's viewers. Pure.
#pragma once

#include <cstdint>
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

// The cost of ray marches.
struct WalkCost {
  std::uint64_t cells = 0;   // visited
  std::uint64_t texels = 0;  // visited
};

// Builds the pyramid of a surface.
[[nodiscard]] SurfacePyramid make_surface_pyramid(const TexelSurface& surface);

// The result of intersect(surface, segment), except that after a miss behind an outline `t`, `at`
// and `texel` are undefined. Adds the cost to `cost`.
[[nodiscard]] SurfaceHit intersect(const TexelSurface& surface, const SurfacePyramid& pyramid,
                                   const DisparitySegment& segment, WalkCost* cost = nullptr);

}  // namespace rilievo

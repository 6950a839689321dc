// Over which squares of texels does a ray meet nothing?
//
// A pyramid over a picture's surface: of each square of texels the depths between which its pieces
// of surface lie. A ray that stays in front of all of them, or behind all of them, steps over the
// square at once: the cost of a ray follows what it passes close by, not the texels under it. The
// result is that of the walk from texel to texel (texel_surface.h), which is the definition.
//
// Values are sigma q, sigma = +1 for ordinary pictures and -1 for back-perspective ones: larger is
// nearer to the picture's viewers. Pure.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/warp/texel_surface.h"

namespace rilievo {

struct SurfaceCell {
  // Of the pieces in it; a cell without any is in front of nothing and behind nothing.
  float front = -1e30f, back = 1e30f;
  bool holes = false;  // has it texels without a piece?
};

struct SurfacePyramid {
  static constexpr int kBlock = 4;   // texels a side of a cell of the finest level
  static constexpr int kFactor = 4;  // cells a side of the next level's cell
  static constexpr int kLevels = 4;
  // levels[0] is the finest.
  std::vector<Image<SurfaceCell>> levels;
};

// What a walk took.
struct WalkCost {
  std::uint64_t cells = 0;   // that were looked at
  std::uint64_t texels = 0;  // that were walked through
};

[[nodiscard]] SurfacePyramid make_surface_pyramid(const TexelSurface& surface);

// As intersect(surface, segment). After a miss behind an outline `t`, `at` and `texel` mean
// nothing. Adds what it took to `cost`.
[[nodiscard]] SurfaceWalk intersect(const TexelSurface& surface, const SurfacePyramid& pyramid,
                                    const DisparitySegment& segment, WalkCost* cost = nullptr);

}  // namespace rilievo

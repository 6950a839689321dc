// How do some rays together meet a picture's surface? Internal to `layered_impostor/software`.
//
// As intersect(surface, segment) in warp/texel_surface.h, over a pyramid of cells, in single
// precision and by SIMD.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/image.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/warp/surface_pyramid.h"
#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// A surface and its pyramid, as rays look them up.
struct MarchSurface {
  // SurfaceTexel without what rays do not ask for.
  struct Texel {
    float q = 0;
    float slope[4] = {};
    std::uint32_t links = 0;
  };
  int width = 0, height = 0;
  float sigma = 1;      // as SurfacePyramid's
  float gap_per_q = 0;  // see patch_gap_per_q()
  std::vector<Texel> texels;
  Image<glm::vec2> cells;  // pyramid_cells()
  std::array<int, SurfacePyramid::kLevels> level_at{};

  [[nodiscard]] std::size_t bytes() const {
    return texels.size() * sizeof(Texel) + cells.texels().size() * kCellBytes;
  }
};
// Lays a surface out.
[[nodiscard]] MarchSurface make_march_surface(const TexelSurface& surface);

// Rays that march together, and where they end. Of each a segment (u, v, q) within the picture, as
// disparity_segment() gives it.
struct MarchRays {
  static constexpr int kCount = 8;
  alignas(64) float from[3][kCount] = {}, to[3][kCount] = {};
  // A bit for each ray: it is marched, and what SurfaceHit says of it.
  std::uint32_t wanted = 0;
  std::uint32_t hit = 0, passed_behind = 0, passed_outline = 0;
  // Of hits, and of what passed behind edges but no outlines: SurfaceHit::t and texel.
  alignas(64) float t[kCount] = {};
  alignas(64) std::int32_t x[kCount] = {}, y[kCount] = {};
  // Of what passed behind edges: SurfaceHit::behind_from, and behind_to or a little later.
  alignas(64) float behind_from[kCount] = {}, behind_to[kCount] = {};
  // What it cost: steps that some of the rays took together.
  int cell_steps = 0, texel_steps = 0;
};

// Marches through the surface.
void march_rays(const MarchSurface& surface, MarchRays& rays);

}  // namespace rilievo

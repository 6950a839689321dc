#include "rilievo/warp/surface_pyramid.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

// Pieces are bounded in floats.
float outwards(float q, float side) { return q + side * 1e-6f * std::abs(q); }

void add(const SurfaceCell& cell, SurfaceCell& to) {
  to.front = std::max(to.front, cell.front);
  to.back = std::min(to.back, cell.back);
  to.holes = to.holes || cell.holes;
}

// A cell's side is a power of two: coordinates of cells are those of texels without some bits.
constexpr int kBlockBits = 2, kFactorBits = 2;
static_assert(1 << kBlockBits == SurfacePyramid::kBlock);
static_assert(1 << kFactorBits == SurfacePyramid::kFactor);
constexpr int bits_of(int level) { return kBlockBits + level * kFactorBits; }

}  // namespace

SurfacePyramid make_surface_pyramid(const TexelSurface& surface) {
  const float sigma = surface.camera.keeps_farthest() ? -1.0f : 1.0f;
  const int w = surface.texels.width(), h = surface.texels.height();
  SurfacePyramid pyramid;
  for (int level = 0; level < SurfacePyramid::kLevels; ++level) {
    const int bits = bits_of(level), more = (1 << bits) - 1;
    pyramid.levels.emplace_back((w + more) >> bits, (h + more) >> bits);
  }
  Image<SurfaceCell>& finest = pyramid.levels[0];
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const SurfaceTexel& texel = surface.texels(x, y);
      SurfaceCell piece;
      piece.holes = texel.q == 0;
      if (!piece.holes) {
        const DepthInterval interval = depth_interval(texel);
        const auto [low, high] = std::minmax({sigma / interval.front, sigma / interval.back});
        piece.front = outwards(high, 1), piece.back = outwards(low, -1);
      }
      add(piece, finest(x / SurfacePyramid::kBlock, y / SurfacePyramid::kBlock));
    }
  for (std::size_t level = 1; level < pyramid.levels.size(); ++level) {
    const Image<SurfaceCell>& finer = pyramid.levels[level - 1];
    for (int y = 0; y < finer.height(); ++y)
      for (int x = 0; x < finer.width(); ++x)
        add(finer(x, y),
            pyramid.levels[level](x / SurfacePyramid::kFactor, y / SurfacePyramid::kFactor));
  }
  return pyramid;
}

}  // namespace rilievo

// The walk keeps three things from texel to texel: is it in front of the surface, has it passed
// behind an edge, and behind an outline. Over a cell
//
//   front of all pieces    nothing is met, and it leaves in front, whatever it was before
//   behind all pieces      if it was behind, it stays so; with holes in the cell it comes out in
//                          front over each and passes behind an outline again. That is news only
//                          the first time: then the texels are walked. Later it may leave the cell
//                          as "behind" even if over a hole: holes have no links, by which alone the
//                          next texel would tell the difference
//
// and otherwise the next finer level is asked, and the texels at last.

#include "rilievo/warp/surface_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "rilievo/warp/texel_march.h"

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

SurfaceHit intersect(const TexelSurface& surface, const SurfacePyramid& pyramid,
                     const DisparitySegment& segment, WalkCost* cost) {
  const TexelMarch walker{surface, segment, surface.camera.keeps_farthest() ? -1.0 : 1.0};
  const glm::dvec2 from(segment.from), step(segment.to - segment.from);
  const glm::ivec2 size{surface.texels.width(), surface.texels.height()};
  glm::ivec2 forward, ahead;
  glm::dvec2 per_step, never;  // of an axis along which the segment does not move
  for (int a = 0; a < 2; ++a) {
    const bool moves = std::abs(step[a]) > 1e-12;
    ahead[a] = step[a] >= 0;
    forward[a] = 2 * ahead[a] - 1;
    per_step[a] = moves ? 1 / step[a] : 0;
    never[a] = moves ? 0 : 1e300;
  }
  // Of the border of [low, low + side) in front, on either axis.
  const auto exits = [&](const glm::ivec2& low, int side) {
    return (glm::dvec2(low + ahead * side) - from) * per_step + never;
  };
  std::array<const SurfaceCell*, SurfacePyramid::kLevels> cells;
  std::array<int, SurfacePyramid::kLevels> cells_wide;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] = pyramid.levels[i].texels().data();
    cells_wide[i] = pyramid.levels[i].width();
  }

  SurfaceHit march;
  WalkCost spent;
  glm::ivec2 texel = glm::clamp(glm::ivec2(glm::floor(from)), glm::ivec2(0), size - 1);
  glm::ivec2 moved{0};       // the step that led here
  double t = 0, before = 1;  // the side that the last texel was left on
  int level = SurfacePyramid::kLevels - 1;
  const auto run = [&] {
    for (;;) {
      const int bits = bits_of(level), side = 1 << bits;
      const glm::ivec2 at = texel >> bits, low = at << bits;
      const auto l = std::size_t(level);
      const SurfaceCell& cell = cells[l][std::ptrdiff_t(at.y) * cells_wide[l] + at.x];
      ++spent.cells;
      const glm::dvec2 ends = exits(low, side);
      const double end = std::min({ends.x, ends.y, 1.0});
      const double z0 = walker.sigma * walker.at(t).z, z1 = walker.sigma * walker.at(end).z;
      const bool in_front = std::min(z0, z1) > double(cell.front);
      const bool behind = before <= 0 && std::max(z0, z1) < double(cell.back) &&
                          (!cell.holes || march.passed_outline);
      if (in_front || behind) {
        if (end >= 1) return;
        const int axis = ends.x <= ends.y ? 0 : 1;
        // A cell at the border may reach beyond the picture.
        const glm::ivec2 last = glm::min(low + side, size) - 1;
        for (int a = 0; a < 2; ++a)
          texel[a] = std::clamp(int(std::floor(from[a] + step[a] * end)), low[a], last[a]);
        texel[axis] = low[axis] + (forward[axis] > 0 ? side : -1);
        moved = glm::ivec2(0);
        moved[axis] = forward[axis];
        t = end;
        before = in_front ? 1 : -1;
        if (texel[axis] < 0 || texel[axis] >= size[axis]) return;
        // Into another cell of the coarser level: that may be stepped over as a whole.
        const int coarser = bits + kFactorBits;
        if (level + 1 < SurfacePyramid::kLevels && texel[axis] >> coarser != low[axis] >> coarser)
          ++level;
        continue;
      }
      if (level > 0) {
        --level;
        continue;
      }
      do {
        ++spent.texels;
        const double enters = walker.side(texel, t);
        if (before > 0 && enters <= 0) {
          const bool from_outside = moved == glm::ivec2(0);
          const glm::ivec2 last = texel - moved;
          const bool hole = from_outside || surface.texels(last.x, last.y).q == 0;
          march.t = t, march.at = walker.at(t);
          march.hit = !hole && walker.meets(last, texel, t);
          march.texel = march.hit ? texel : last;
          if (march.hit) return;
          march.passed_behind = true;
          march.passed_end = march.passed_end || hole || !walker.linked(last, texel);
          march.passed_outline = march.passed_outline || hole;
        }
        const glm::dvec2 borders = exits(texel, 1);
        const double leave = std::min({borders.x, borders.y, 1.0});
        const double leaves = walker.side(texel, leave);
        if (enters > 0 && leaves <= 0) {
          march.hit = true;
          march.t = walker.root(texel, t, leave);
          march.at = walker.at(march.t);
          march.texel = texel;
          return;
        }
        if (leave >= 1) return;
        const int axis = borders.x <= borders.y ? 0 : 1;
        moved = glm::ivec2(0);
        moved[axis] = forward[axis];
        texel += moved;
        t = leave;
        before = leaves;
        if (texel[axis] < 0 || texel[axis] >= size[axis]) return;
      } while (texel >> bits == at);
      if (texel >> (bits + kFactorBits) != at >> kFactorBits) ++level;
    }
  };
  run();
  if (cost) cost->cells += spent.cells, cost->texels += spent.texels;
  return march;
}

}  // namespace rilievo

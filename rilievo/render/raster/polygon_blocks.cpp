#include "rilievo/render/raster/polygon_blocks.h"

#include <algorithm>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/raster/polygon_blocks.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

constexpr int kBlock = FrameTile::kBlock;

// Lanes are pixels of a row.
using F = hn::CappedTag<float, kBlock>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<F>;

// The samples of as many pixels as a vector has lanes.
template <int kSamples>
struct Pixels {
  VF depth[kSamples];
  VU triangle[kSamples];

  Pixels(const float* depths, const std::uint32_t* triangles) requires(kSamples == 4) {
    hn::LoadInterleaved4(F(), depths, depth[0], depth[1], depth[2], depth[3]);
    hn::LoadInterleaved4(U(), triangles, triangle[0], triangle[1], triangle[2], triangle[3]);
  }
  Pixels(const float* depths, const std::uint32_t* triangles) requires(kSamples == 1) {
    depth[0] = hn::LoadU(F(), depths);
    triangle[0] = hn::LoadU(U(), triangles);
  }
  [[nodiscard]] Mask covered(int s) const { return hn::Lt(depth[s], hn::Set(F(), 1.0f)); }
  [[nodiscard]] Mask covered_anywhere() const {
    Mask any = covered(0);
    for (int s = 1; s < kSamples; ++s) any = hn::Or(any, covered(s));
    return any;
  }
  [[nodiscard]] Mask whole() const {
    Mask whole = covered(0);
    for (int s = 1; s < kSamples; ++s)
      whole = hn::And(hn::And(whole, covered(s)),
                      hn::RebindMask(F(), hn::Eq(triangle[s], triangle[0])));
    return whole;
  }
};

// Calls visit(pixels, x) for vectors of a row from the left.
template <int kSamples, class Visit>
HWY_INLINE void for_row(const BlockSamples& in, int row, const Visit& visit) {
  const int lanes = int(hn::Lanes(F()));
  for (int x = 0; x < kBlock; x += lanes)
    visit(Pixels<kSamples>(in.depths[row] + x * kSamples, in.triangles[row] + x * kSamples), x);
}

// What holds each sample of a block: the first plane for all, or one each.
template <int kSamples>
struct BlockPlanes {
  int count = 1;
  FrameTile::Plane* of[kSamples];

  BlockPlanes(FrameTile& tile, int block) {
    for (int s = 0; s < kSamples; ++s) of[s] = &tile.first[block];
    if (kSamples == 1 || !tile.expanded[block]) return;
    count = kSamples;
    for (int s = 1; s < kSamples; ++s) of[s] = &tile.more[block][s - 1];
  }
};

HWY_INLINE VF inverse_z(const TileDepth& tile_depth, VF window_z) {
  const F f;
  return hn::Add(hn::Set(f, tile_depth.inverse_far), hn::Mul(hn::Sub(hn::Set(f, 1.0f), window_z),
                                                             hn::Set(f, tile_depth.inverse_range)));
}

template <int kSamples>
BlockCoverage coverage(const BlockSamples& in) {
  const F f;
  Mask any = hn::FirstN(f, 0), partial = any;
  for (int row = 0; row < kBlock; ++row)
    for_row<kSamples>(in, row, [&](const Pixels<kSamples>& pixels, int) {
      const Mask covered = pixels.covered_anywhere();
      any = hn::Or(any, covered);
      partial = hn::Or(partial, hn::AndNot(pixels.whole(), covered));
    });
  return {!hn::AllFalse(f, any), !hn::AllFalse(f, partial)};
}

template <int kSamples>
void depths(const BlockSamples& in, const TileDepth& tile_depth, std::uint32_t content,
            FrameTile& tile, int block) {
  const F f;
  const U u;
  const BlockPlanes<kSamples> planes(tile, block);
  for (int s = 0; s < planes.count; ++s) {
    FrameTile::Plane& plane = *planes.of[s];
    for (int row = 0; row < kBlock; ++row)
      for_row<kSamples>(in, row, [&](const Pixels<kSamples>& pixels, int x) {
        float* depth = plane.inverse_z + row * kBlock + x;
        std::uint32_t* shown = plane.content + row * kBlock + x;
        const VF now = inverse_z(tile_depth, pixels.depth[s]), before = hn::Load(f, depth);
        const Mask nearer = hn::And(pixels.covered(s), hn::Gt(now, before));
        hn::Store(hn::IfThenElse(nearer, now, before), f, depth);
        hn::Store(
            hn::IfThenElse(hn::RebindMask(u, nearer), hn::Set(u, content), hn::Load(u, shown)), u,
            shown);
      });
  }
}

PixelBits bits_of(Mask mask) {
  std::uint8_t bits[8];  // that many are written
  hn::StoreMaskBits(F(), mask, bits);
  return bits[0];
}

template <int kSamples>
VisibleRow visible(const BlockSamples& in, const TileDepth& tile_depth, FrameTile& tile, int block,
                   int row) {
  const F f;
  const BlockPlanes<kSamples> planes(tile, block);
  VisibleRow out;
  for_row<kSamples>(in, row, [&](const Pixels<kSamples>& pixels, int x) {
    const Mask whole = pixels.whole();
    out.whole = PixelBits(out.whole | bits_of(whole) << x);
    const VF first = inverse_z(tile_depth, pixels.depth[0]);
    for (int s = 0; s < kSamples; ++s) {
      const VF now = hn::Load(f, planes.of[s]->inverse_z + row * kBlock + x);
      const Mask same = hn::Or(hn::Eq(now, inverse_z(tile_depth, pixels.depth[s])),
                               hn::And(whole, hn::Eq(now, first)));
      out.visible[s] = PixelBits(out.visible[s] | bits_of(hn::And(pixels.covered(s), same)) << x);
    }
  });
  return out;
}

BlockCoverage find(const BlockSamples& in) {
  return in.samples == 4 ? coverage<4>(in) : coverage<1>(in);
}
void draw(const BlockSamples& in, const TileDepth& tile_depth, std::uint32_t content,
          FrameTile& tile, int block) {
  in.samples == 4 ? depths<4>(in, tile_depth, content, tile, block)
                  : depths<1>(in, tile_depth, content, tile, block);
}
VisibleRow look(const BlockSamples& in, const TileDepth& tile_depth, FrameTile& tile, int block,
                int row) {
  return in.samples == 4 ? visible<4>(in, tile_depth, tile, block, row)
                         : visible<1>(in, tile_depth, tile, block, row);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(find);
HWY_EXPORT(draw);
HWY_EXPORT(look);

BlockSamples::BlockSamples(const SampleBuffer& in, int x, int y) : samples(in.samples) {
  constexpr int kBlock = FrameTile::kBlock;
  const int columns = std::min(kBlock, in.width - x), rows = std::min(kBlock, in.height - y);
  for (int row = 0; row < kBlock; ++row) {
    float* beyond = beyond_depths_[row];
    depths[row] = beyond, triangles[row] = beyond_triangles_[row];
    if (row < rows) {
      const std::size_t at =
          in.row(in.height - 1 - y - row) + std::size_t(x) * std::size_t(samples);
      if (columns == kBlock) {
        depths[row] = &in.depth[at], triangles[row] = &in.triangle[at];
        continue;
      }
      beyond = std::copy_n(&in.depth[at], columns * samples, beyond);
      std::copy_n(&in.triangle[at], columns * samples, beyond_triangles_[row]);
    }
    std::fill(beyond, beyond_depths_[row] + kBlock * samples, 1.0f);
    std::fill_n(beyond_triangles_[row] + (beyond - beyond_depths_[row]),
                beyond_depths_[row] + kBlock * samples - beyond, 0u);
  }
}

BlockCoverage find_coverage(const BlockSamples& in) { return HWY_DYNAMIC_DISPATCH(find)(in); }

void draw_depths(const BlockSamples& in, const TileDepth& tile_depth, std::uint32_t content,
                 FrameTile& tile, int block) {
  HWY_DYNAMIC_DISPATCH(draw)(in, tile_depth, content, tile, block);
}

VisibleRow find_visible(const BlockSamples& in, const TileDepth& tile_depth, FrameTile& tile,
                        int block, int row) {
  return HWY_DYNAMIC_DISPATCH(look)(in, tile_depth, tile, block, row);
}

}  // namespace rilievo
#endif

// A block of 8 x 8 pixels at a time, in three passes over it: depth (which pixels show the picture
// and are nearest), colour of those, then the samples. A block is left as soon as nothing of it
// remains: by the picture's nearest depth, by the cells under it, after the depth test.
//
// Depth takes one division for the texel and one for 1 / eye_z (nailboard_composer.cpp). Colours
// are interpolated in 15 bits, two channels in each 32-bit lane: R and B, G and A. No fused
// multiply-adds and no estimates: every instruction set gives the same bytes.
#include "rilievo/nailboard/software/compose_tile.h"

#include <algorithm>
#include <cmath>
#include <limits>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/nailboard/software/compose_tile.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/nailboard/software/texel_span.inl"

#include "rilievo/render/software/tile_kernels.inl"

#include "rilievo/nailboard/software/block_look.inl"

// Alpha 1 in 15 bits, as all channels.
constexpr int kOne = 255 * 128;
// Sample s is covered where alpha is above kThreshold[s]: OpenGL's alpha to coverage, as Mesa has
// it, and what its shader discards. With one sample: where alpha is not below one half.
constexpr int kThreshold[4] = {kOne / 8 - 1, kOne / 4, kOne / 2, kOne * 3 / 4};
constexpr int kThresholdAlone = kOne / 2 - 1;
// The same of SampleRounding::nearest.
constexpr int kThresholdNearest[4] = {kOne / 8 - 1, kOne * 3 / 8 - 1, kOne * 5 / 8 - 1,
                                      kOne * 7 / 8 - 1};

// The centres of a block's pixels.
struct Centers {
  alignas(64) float x[kPixels], y[kPixels];
  constexpr Centers() : x(), y() {
    for (int i = 0; i < kPixels; ++i)
      x[i] = float(i % kBlock) + 0.5f, y[i] = float(i / kBlock) + 0.5f;
  }
};
constexpr Centers kCenters;

// What the first pass leaves to the others.
struct Found {
  HWY_ALIGN float u[kPixels], v[kPixels];  // texels, less one half
  HWY_ALIGN float inverse_z[kPixels];
  HWY_ALIGN std::uint32_t shown[kPixels];  // all bits: to be drawn
  HWY_ALIGN std::uint32_t color[kPixels];
  HWY_ALIGN std::int32_t alpha[kPixels];
  HWY_ALIGN std::uint32_t covered[4][kPixels];  // all bits: the sample is on the polygon; if `cut`
  bool cut;                                     // the polygon's edge passes between samples
  std::uint64_t groups;                         // bit g: the g-th vector has something to draw
};

// Which samples of some pixels does the polygon cover? Its edges are where u, v, width - u or
// height
// - v is 0, or times w, which is affine, so that no sample needs a division. Given are their values
// at the pixels' centres.
HWY_INLINE MF find_covered(const Board& board, VF u, VF v, VF w, int i, Found& found) {
  const F f;
  const U u32;
  const VF zero = hn::Zero(f);
  const float width = float(board.picture.width()), height = float(board.picture.height());
  const VF right = hn::Sub(hn::Mul(w, hn::Set(f, width)), u);
  const VF bottom = hn::Sub(hn::Mul(w, hn::Set(f, height)), v);
  MF any = hn::Lt(zero, zero), all = hn::Eq(zero, zero);
  for (int s = 0; s < 4; ++s) {
    const float dx = FrameTile::kSampleX[s] - 0.5f, dy = FrameTile::kSampleY[s] - 0.5f;
    const auto step = [&](const Plane& plane) { return dx * plane.per_x + dy * plane.per_y; };
    const float du = step(board.u), dv = step(board.v), dw = step(board.w);
    const auto inside = [&](VF at, float by) { return hn::Ge(hn::Add(at, hn::Set(f, by)), zero); };
    const MF covered = hn::And(hn::And(inside(u, du), inside(right, dw * width - du)),
                               hn::And(inside(v, dv), inside(bottom, dw * height - dv)));
    hn::Store(hn::VecFromMask(u32, hn::RebindMask(u32, covered)), u32, found.covered[s] + i);
    any = hn::Or(any, covered), all = hn::And(all, covered);
  }
  found.cut = found.cut || !hn::AllFalse(f, hn::AndNot(all, any));
  return any;
}

// Pass 1: which pixels show the picture, and are nearer than a sample of the block?
template <Reach reach, bool inside>
HWY_INLINE bool find_depths(const Board& board, const FrameTile& tile, int block, int x, int y,
                            const Patch& patch, Found& found) {
  const F f;
  const I i32;
  const U u32;
  const SoftwareNailboard& picture = board.picture;
  const PlacedNailboard& placed = board.placed;
  const VF half = hn::Set(f, 0.5f), one = hn::Set(f, 1.0f);
  const VF width = hn::Set(f, float(picture.width())), height = hn::Set(f, float(picture.height()));
  const VF inverse_near = hn::Set(f, placed.inverse_near);
  const bool share = placed.share_from > 0 || placed.share_to < 1;
  const bool by_sample = !inside && tile.samples == 4;
  found.cut = false;
  std::uint64_t groups = 0;
  int group = 0;
  for (int i = 0; i < kPixels; i += int(hn::Lanes(f)), ++group) {
    const VF dx = hn::Load(f, kCenters.x + i), dy = hn::Load(f, kCenters.y + i);
    const auto at = [&](float corner, const Plane& plane) {
      return hn::Add(hn::Set(f, corner), hn::Add(hn::Mul(dx, hn::Set(f, plane.per_x)),
                                                 hn::Mul(dy, hn::Set(f, plane.per_y))));
    };
    VF w = at(patch.w, board.w);
    MF shown = hn::Gt(w, hn::Set(f, tile.nothing));
    if constexpr (!inside) {
      shown = hn::And(shown, hn::Le(w, inverse_near));
      w = hn::IfThenElse(shown, w, one);
    }
    const VF eye_z = hn::Div(one, w);
    const VF u_w = at(patch.u, board.u), v_w = at(patch.v, board.v);
    VF u = hn::Mul(u_w, eye_z), v = hn::Mul(v_w, eye_z);
    if constexpr (!inside) {
      const VF zero = hn::Zero(f);
      const MF covered = by_sample ? find_covered(board, u_w, v_w, w, i, found)
                                   : hn::And(hn::And(hn::Ge(u, zero), hn::Lt(u, width)),
                                             hn::And(hn::Ge(v, zero), hn::Lt(v, height)));
      shown = hn::And(shown, covered);
      // Colours of edges do not reach beyond them.
      u = hn::Min(hn::Max(u, half), hn::Sub(width, half));
      v = hn::Min(hn::Max(v, half), hn::Sub(height, half));
    }
    const VU code = codes_of<reach>(picture, hn::ConvertTo(i32, u), hn::ConvertTo(i32, v));
    const VF steps = hn::ConvertTo(f, hn::BitCast(i32, code));
    shown = hn::And(shown, hn::Le(steps, hn::Set(f, float(picture.steps()))));
    const VF q = hn::Add(hn::Set(f, placed.q_first), hn::Mul(hn::Set(f, placed.q_per_code), steps));
    VF inverse_z;
    if (placed.exact) {
      const VF e = hn::Set(f, placed.eye_z);
      inverse_z = hn::Div(q, hn::Add(hn::Mul(q, e), hn::Sub(eye_z, e)));
    } else {
      inverse_z = hn::Mul(q, w);
    }
    inverse_z = hn::Min(inverse_z, inverse_near);
    VF least = hn::Load(f, tile.first[block].inverse_z + i);
    if (tile.expanded[block])
      for (const FrameTile::Plane& plane : tile.more[block])
        least = hn::Min(least, hn::Load(f, plane.inverse_z + i));
    shown = hn::And(shown, hn::Gt(inverse_z, least));
    if (share) {
      const VF hash = pixel_hash(f, tile, x, y, dx, dy);
      shown = hn::And(shown, hn::And(hn::Ge(hash, hn::Set(f, placed.share_from)),
                                     hn::Lt(hash, hn::Set(f, placed.share_to))));
    }
    if (hn::AllFalse(f, shown)) continue;
    groups |= std::uint64_t(1) << group;
    hn::Store(hn::Sub(u, half), f, found.u + i);
    hn::Store(hn::Sub(v, half), f, found.v + i);
    hn::Store(inverse_z, f, found.inverse_z + i);
    hn::Store(hn::VecFromMask(u32, hn::RebindMask(u32, shown)), u32, found.shown + i);
  }
  found.groups = groups;
  return groups != 0;
}

// Pass 2: colours between four texels, un-premultiplied; alpha in 15 bits.
template <Reach reach, bool opaque, class Group>
HWY_INLINE void find_colors(const SoftwareNailboard& picture, Found& found,
                            const Group& each_group) {
  const F f;
  const I i32;
  const U u32;
  each_group([&](int i) {
    const VF u = hn::Load(f, found.u + i), v = hn::Load(f, found.v + i);
    const VI column = hn::ConvertTo(i32, u), row = hn::ConvertTo(i32, v);
    const auto weight = [&](VF at, VI below) {
      const VF part = hn::Sub(at, hn::ConvertTo(f, below));
      const VU bits = hn::BitCast(u32, hn::ConvertTo(i32, hn::Mul(part, hn::Set(f, 32768.0f))));
      return hn::Or(bits, hn::ShiftLeft<16>(bits));
    };
    const VU x = weight(u, column), y = weight(v, row);
    const auto [a, b, c, d] = colors_of<reach>(picture, column, row);
    // Bytes 0 and 2, and 1 and 3, by 128.
    const VU bits = hn::Set(u32, 0x7f807f80u);
    const auto even = [&](VU t) { return hn::And(hn::ShiftLeft<7>(t), bits); };
    const auto odd = [&](VU t) { return hn::And(hn::ShiftRight<1>(t), bits); };
    const VU rb = between(even(a), even(b), even(c), even(d), x, y);
    const VU ga = between(odd(a), odd(b), odd(c), odd(d), x, y);
    const auto join = [&](VU low, VU high) {
      return hn::Or(hn::Or(low, hn::ShiftLeft<8>(high)), hn::Set(u32, 0xff000000u));
    };
    if constexpr (opaque) {
      hn::Store(join(to_bytes(rb), to_bytes(ga)), u32, found.color + i);
      return;
    }
    const VU alpha = hn::ShiftRight<16>(ga);
    hn::Store(hn::BitCast(i32, alpha), i32, found.alpha + i);
    // 255 * 16 color / alpha in 16 bits; below 1 / 8 nothing is drawn.
    const VI least = hn::Max(hn::BitCast(i32, alpha), hn::Set(i32, kThreshold[0] + 1));
    const VU per_alpha = hn::BitCast(
        u32, hn::ConvertTo(i32, hn::Div(hn::Set(f, float(kOne) * 4096), hn::ConvertTo(f, least))));
    const VU factor = hn::Or(per_alpha, hn::ShiftLeft<16>(per_alpha));
    hn::Store(join(divide(rb, factor), divide(ga, factor)), u32, found.color + i);
  });
}

// Instead of colours, identifiers. An empty texel has a depth for the colours that reach into it,
// but no object.
template <class Group>
HWY_INLINE void find_objects(const Board& board, Found& found, const Group& each_group) {
  const F f;
  const I i32;
  const U u32;
  const SoftwareNailboard& picture = board.picture;
  each_group([&](int i) {
    const VF half = hn::Set(f, 0.5f);
    const VI column = hn::ConvertTo(i32, hn::Add(hn::Load(f, found.u + i), half)),
             row = hn::ConvertTo(i32, hn::Add(hn::Load(f, found.v + i), half));
    const VI texel = hn::Add(hn::Mul(row, hn::Set(i32, picture.stride())), column);
    const VU color = hn::GatherIndex(u32, picture.color(), texel);
    const VU covered = hn::VecFromMask(u32, hn::Gt(color, hn::Set(u32, 0x00ffffffu)));
    VU object = hn::Set(u32, board.placed.object);
    if (board.placed.object == kNoObject && picture.objects())
      object = hn::GatherIndex(u32, picture.objects(), texel);
    // Colours of 4 samples reach over a centre that shows nothing.
    const VU any = hn::VecFromMask(u32, hn::Ne(object, hn::Set(u32, kNoObject)));
    hn::Store(hn::And(hn::Load(u32, found.shown + i), hn::And(covered, any)), u32, found.shown + i);
    hn::Store(object, u32, found.color + i);
  });
}

HWY_INLINE void put(FrameTile::Plane& plane, int i, const Found& found, hn::Mask<U> where) {
  const F f;
  const U u32;
  const VU content =
      hn::IfThenElse(where, hn::Load(u32, found.color + i), hn::Load(u32, plane.content + i));
  const VF depth = hn::IfThenElse(hn::RebindMask(f, where), hn::Load(f, found.inverse_z + i),
                                  hn::Load(f, plane.inverse_z + i));
  hn::Store(content, u32, plane.content + i);
  hn::Store(depth, f, plane.inverse_z + i);
}

// Pass 3.
template <class Group>
HWY_INLINE void put_samples(FrameTile& tile, int block, bool opaque, const int* threshold,
                            const Found& found, const Group& each_group) {
  const F f;
  const I i32;
  const U u32;
  const auto shown = [&](int i) { return hn::Ne(hn::Load(u32, found.shown + i), hn::Zero(u32)); };
  const auto covered = [&](int i, int s) {
    return hn::Ne(hn::Load(u32, found.covered[s] + i), hn::Zero(u32));
  };
  const auto above = [&](int i, int least) {
    return hn::RebindMask(u32, hn::Gt(hn::Load(i32, found.alpha + i), hn::Set(i32, least)));
  };
  if (tile.samples == 1) {
    each_group([&](int i) {
      auto where = shown(i);
      if (!opaque) where = hn::And(where, above(i, kThresholdAlone));
      put(tile.first[block], i, found, where);
    });
    return;
  }
  if (!opaque && !tile.expanded[block]) {
    bool partial = found.cut;
    each_group([&](int i) {
      const auto some = hn::AndNot(above(i, threshold[3]), above(i, threshold[0]));
      partial = partial || !hn::AllFalse(u32, hn::And(shown(i), some));
    });
    if (partial) tile.expand(block);
  }
  const int planes = tile.planes(block);
  for (int s = 0; s < planes; ++s) {
    FrameTile::Plane& plane = tile.plane(block, s);
    each_group([&](int i) {
      auto where = shown(i);
      if (!opaque) where = hn::And(where, above(i, threshold[s]));
      if (found.cut) where = hn::And(where, covered(i, s));
      // Pass 1 compared with the farthest of the samples.
      if (planes > 1)
        where = hn::And(where, hn::RebindMask(u32, hn::Gt(hn::Load(f, found.inverse_z + i),
                                                          hn::Load(f, plane.inverse_z + i))));
      put(plane, i, found, where);
    });
  }
}

// All passes over a block; has it changed?
template <Reach reach, bool inside, bool opaque>
HWY_NOINLINE bool draw_block(const Board& board, FrameTile& tile, int block, int x, int y,
                             const Patch& patch) {
  Found found;
  if (!find_depths<reach, inside>(board, tile, block, x, y, patch, found)) return false;
  const auto each_group = [&](const auto& visit) {
    const F f;
    for (std::uint64_t left = found.groups; left != 0; left &= left - 1)
      visit(int(hwy::Num0BitsBelowLS1Bit_Nonzero64(left) * hn::Lanes(f)));
  };
  find_colors<reach, opaque>(board.picture, found, each_group);
  if (tile.of == TileContent::object_id) find_objects(board, found, each_group);
  put_samples(tile, block, opaque, board.placed.nearest_coverage ? kThresholdNearest : kThreshold,
              found, each_group);
  return true;
}

template <Reach reach>
HWY_INLINE bool draw_block(const Board& board, FrameTile& tile, int block, int x, int y,
                           const Patch& patch) {
  if (!patch.inside) return draw_block<reach, false, false>(board, tile, block, x, y, patch);
  if (!patch.opaque) return draw_block<reach, true, false>(board, tile, block, x, y, patch);
  return draw_block<reach, true, true>(board, tile, block, x, y, patch);
}

// In how many blocks?
int draw_board(const Board& board, FrameTile& tile) {
  int drawn = 0;
  const PlacedNailboard& placed = board.placed;
  const auto block_of = [](int pixel, int corner) { return (pixel - corner) / kBlock; };
  const int x0 = block_of(std::max(placed.x0, tile.x), tile.x),
            y0 = block_of(std::max(placed.y0, tile.y), tile.y),
            x1 = block_of(std::min(placed.x1, tile.x + FrameTile::kSize) - 1, tile.x),
            y1 = block_of(std::min(placed.y1, tile.y + FrameTile::kSize) - 1, tile.y);
  for (int by = y0; by <= y1; ++by)
    for (int bx = x0; bx <= x1; ++bx) {
      const int block = by * FrameTile::kBlocks + bx;
      if (placed.nearest <= farthest(tile, block)) continue;
      const float x = float(bx * kBlock), y = float(by * kBlock);
      const auto at = [&](const Plane& p) { return p.at + (x * p.per_x + y * p.per_y); };
      Patch patch{at(board.u), at(board.v), at(board.w)};
      if (!look_at_block(board, tile, block, patch)) continue;
      prefetch_below(board, patch);
      const auto draw = [&]<Reach reach>() {
        return draw_block<reach>(board, tile, block, tile.x + bx * kBlock, tile.y + by * kBlock,
                                 patch);
      };
      const bool changed = patch.reach == Reach::block   ? draw.template operator()<Reach::block>()
                           : patch.reach == Reach::steep ? draw.template operator()<Reach::steep>()
                           : patch.reach == Reach::span  ? draw.template operator()<Reach::span>()
                                                         : draw.template operator()<Reach::any>();
      if (!changed) continue;
      tile.changed[block] = true;
      ++drawn;
    }
  return drawn;
}

void compose(std::span<const PlacedNailboard> placed, std::span<const std::uint32_t> listed,
             std::span<std::uint8_t> blocks, FrameTile& tile) {
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const PlacedNailboard& board = placed[listed[i]];
    // At the tile's corner in double precision; from there on small numbers.
    const glm::dvec3 corner = board.texel_from_raster * glm::dvec3(tile.x, tile.y, 1);
    const glm::dmat3& m = board.texel_from_raster;
    const auto plane = [&](int k) {
      return Plane{float(corner[k]), float(m[0][k]), float(m[1][k])};
    };
    blocks[i] =
        std::uint8_t(draw_board({board, *board.picture, plane(0), plane(1), plane(2)}, tile));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(compose);

void compose_tile(std::span<const PlacedNailboard> placed, std::span<const std::uint32_t> listed,
                  std::span<std::uint8_t> blocks, FrameTile& tile) {
  HWY_DYNAMIC_DISPATCH(compose)(placed, listed, blocks, tile);
}

}  // namespace rilievo
#endif

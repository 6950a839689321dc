// The second pass, fast: kWarpStrip columns are done at once, a vector of columns and their samples
// in two rows the ends of as many pieces. Pieces beside each other mostly begin in the same row or
// two: their first two texels are interpolated together and stored by masks; the rest of longer
// ones, a vector of rows at once. Silhouettes as in the first pass.
#include "rilievo/relief_impostor/warp_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/relief_impostor/warp_columns.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/core/lane_numbers.inl"
#include "rilievo/relief_impostor/warp_texels.inl"

// Pieces of a vector of columns.
struct PieceRows {
  AxisWarp k;
  hn::Mask<U> inside;  // columns of the picture
  const std::uint32_t* in;
  std::uint32_t* out;
  int limit;

  // Of a row. The row after the last shows nothing.
  struct Samples {
    Ends ends;
    VU bits;
    VI cell;
    hn::Mask<I> opaque;
  };
  HWY_INLINE const std::uint32_t* row(int v) const { return in + std::ptrdiff_t(v) * 32; }
  HWY_INLINE float a_of(int v) const { return k.a0 + k.a1 * float(v); }
  HWY_INLINE float b_of(int v) const { return k.b0 + k.b1 * float(v); }
  HWY_INLINE Samples samples_at(int v, std::uint16_t& shows, std::uint16_t& solid, int c) const {
    const F f;
    const U u;
    Samples at;
    at.ends.color = hn::LoadU(u, row(v)), at.bits = hn::LoadU(u, row(v) + 16);
    const VU code = code_of(at.bits);
    const auto there = hn::AndNot(is_empty(code), inside);
    const auto opaque = hn::And(there, is_opaque(at.ends.color));
    shows |= std::uint16_t(bits_of(there) << c), solid |= std::uint16_t(bits_of(opaque) << c);
    at.opaque = hn::RebindMask(I(), opaque);
    at.ends.q = as_float(code);
    at.ends.p = hn::Add(hn::Set(f, a_of(v)), hn::Mul(at.ends.q, hn::Set(f, b_of(v))));
    at.cell = cell_of(at.ends.p, limit);
    return at;
  }

  // Those that begin in row v, and end in the next.
  HWY_INLINE void draw(int v, const Samples& a, const Samples& b) const {
    const F f;
    const I n;
    const U u;
    const VI first = a.cell, count = hn::Sub(b.cell, first);
    const auto covers = hn::And(hn::And(a.opaque, b.opaque), hn::Gt(count, hn::Zero(n)));
    std::uint64_t rest = bits_of(covers);
    if (!rest) return;
    HWY_ALIGN std::int32_t firsts[16];
    hn::Store(first, n, firsts);
    const VF reach = hn::Set(f, k.reach), center = center_of(first);
    VU color, code, color_two, code_two;
    between(a.ends, b.ends, a.bits, b.bits, reach, center, color, code);
    const auto two = hn::And(covers, hn::Gt(count, hn::Set(n, 1)));
    const bool any_two = !hn::AllFalse(n, two);
    if (any_two)
      between(a.ends, b.ends, a.bits, b.bits, reach, hn::Add(center, hn::Set(f, 1.0f)), color_two,
              code_two);
    while (rest) {
      const int row = firsts[std::countr_zero(rest)];
      std::uint32_t* to = out + row * 32;
      const auto here = hn::And(covers, hn::Eq(first, hn::Set(n, row)));
      rest &= ~bits_of(here);
      hn::BlendedStore(color, hn::RebindMask(u, here), u, to);
      hn::BlendedStore(code, hn::RebindMask(u, here), u, to + 16);
      if (!any_two) continue;
      const auto also = hn::RebindMask(u, hn::And(here, two));
      if (hn::AllFalse(u, also)) continue;
      hn::BlendedStore(color_two, also, u, to + 32);
      hn::BlendedStore(code_two, also, u, to + 48);
    }
    if (!any_two) return;
    std::uint64_t more = bits_of(hn::And(two, hn::Gt(count, hn::Set(n, 2))));
    if (!more) return;
    HWY_ALIGN std::int32_t counts[16];
    hn::Store(count, n, counts);
    for (; more; more &= more - 1) draw_rest(v, std::countr_zero(more), firsts, counts);
  }

  // All but the first two texels of a long one.
  HWY_NOINLINE void draw_rest(int v, int lane, const std::int32_t* firsts,
                              const std::int32_t* counts) const {
    const F f;
    const U u;
    const auto one = [&](int of, VU& bits) -> Ends {
      const std::uint32_t* texel = row(of) + lane;
      const auto q = float(texel[16] & 0xffff);
      bits = hn::Set(u, texel[16]);
      return {hn::Set(u, *texel), hn::Set(f, q), hn::Set(f, a_of(of) + q * b_of(of))};
    };
    VU bits_a, bits_b;
    const Ends a = one(v, bits_a), b = one(v + 1, bits_b);
    draw_long(a, b, bits_a, bits_b, hn::Set(f, k.reach), firsts[lane] + 2, counts[lane] - 2,
              [&](VU color, VU code, int y, int count) {
                HWY_ALIGN std::uint32_t color_of[16], code_of[16];
                hn::Store(color, u, color_of);
                hn::Store(code, u, code_of);
                for (int i = 0; i < count; ++i) {
                  std::uint32_t* to = out + (y + i) * 32 + lane;
                  to[0] = color_of[i], to[16] = code_of[i];
                }
              });
  }
};

WarpedTexels do_columns(const AxisWarp& k, const std::uint32_t* in, std::size_t block, int height,
                        int x, int columns, const WarpPlanes& to, int out_height,
                        std::byte* scratch) {
  const F f;
  const I n;
  const U u;
  const int lanes = int(hn::Lanes(f));
  // As the rows: blocks of 16 columns, each row 16 colours and then 16 codes.
  auto* drawn = reinterpret_cast<std::uint32_t*>(scratch);
  const int drawn_block = out_height * 32;
  // A bit for each column of a block, by row: does it show something, and is it opaque?
  auto* shows = reinterpret_cast<std::uint16_t*>(drawn + kWarpStrip / 16 * drawn_block);
  std::fill_n(shows, kWarpStrip / 16 * 2 * (height + 2), 0);
  const auto shows_of = [&](int c) { return shows + c / 16 * 2 * (height + 2) + 1; };
  const auto solid_of = [&](int c) { return shows_of(c) + height + 2; };
  const auto block_of = [&](int c) { return in + std::size_t((x + c) / 16) * block + c % 16; };
  for (int c = 0; c < columns; c += lanes) {
    const PieceRows pieces{k, hn::FirstN(u, std::size_t(columns - c)), block_of(c),
                           drawn + c / 16 * drawn_block + c % 16, out_height};
    for (int y = 0; y < out_height; ++y) {
      hn::StoreU(hn::Zero(u), u, pieces.out + y * 32);
      hn::StoreU(hn::Set(u, kEmptyWarped), u, pieces.out + y * 32 + 16);
    }
    std::uint16_t *shown = shows_of(c), *solid = solid_of(c);
    const auto samples_at = [&](int v) { return pieces.samples_at(v, shown[v], solid[v], c % 16); };
    for (const AxisWarp::Range& range : k.ranges) {
      if (range.from >= range.to) continue;
      if (range.up) {
        PieceRows::Samples a = samples_at(range.from);
        for (int v = range.from; v < range.to; ++v) {
          const PieceRows::Samples b = samples_at(v + 1);
          pieces.draw(v, a, b);
          a = b;
        }
      } else {
        PieceRows::Samples b = samples_at(range.to);
        for (int v = range.to - 1; v >= range.from; --v) {
          const PieceRows::Samples a = samples_at(v);
          pieces.draw(v, a, b);
          b = a;
        }
      }
    }
  }
  WarpedTexels counted;
  HWY_ALIGN std::uint32_t last_colors[16];
  HWY_ALIGN std::uint16_t deltas[16], bits[16];
  for (int y = 0; y < out_height; ++y)
    for (int c = 0; c < columns; c += lanes) {
      const std::size_t at_texel = std::size_t(y) * to.pitch + std::size_t(x + c);
      const std::uint32_t* texels = drawn + c / 16 * drawn_block + y * 32 + c % 16;
      const VU color = hn::LoadU(u, texels), code = hn::LoadU(u, texels + 16);
      counted.covered += std::size_t(lanes) - hn::CountTrue(u, is_empty(code));
      const auto bit = hn::Set(u, kInterpolatedBit);
      counted.interpolated += hn::CountTrue(u, hn::Eq(hn::And(code, bit), bit));
      const auto delta = hn::DemoteTo(U16(), hn::BitCast(n, code_of(code)));
      const auto flags = hn::DemoteTo(U16(), hn::BitCast(n, hn::ShiftRight<16>(code)));
      if (c + lanes <= columns) {
        hn::StoreU(color, u, to.color + at_texel);
        hn::StoreU(delta, U16(), to.delta + at_texel);
        hn::StoreU(flags, U16(), to.flags + at_texel);
      } else {
        // The rest by way of memory of our own: beyond it lies what others write.
        hn::StoreU(color, u, last_colors);
        hn::StoreU(delta, U16(), deltas);
        hn::StoreU(flags, U16(), bits);
        std::copy_n(last_colors, columns - c, to.color + at_texel);
        std::copy_n(deltas, columns - c, to.delta + at_texel);
        std::copy_n(bits, columns - c, to.flags + at_texel);
      }
    }
  const auto draw_edges = [&](int v, int at, const std::uint16_t* shown,
                              const std::uint16_t* solid) {
    const int edges = shown[v] & ~(solid[v - 1] & solid[v] & solid[v + 1]);
    for (unsigned bits = unsigned(edges); bits; bits &= bits - 1) {
      const int c = at + std::countr_zero(bits);
      const auto texel = [&](int row) -> std::optional<WarpTexel> {
        if (!(shown[row] >> (c - at) & 1)) return std::nullopt;
        const std::uint32_t* from = block_of(c) + std::ptrdiff_t(row) * 32;
        return WarpTexel{from[0], from[16]};
      };
      const auto before = texel(v - 1), here = texel(v), after = texel(v + 1);
      draw_silhouette(k, v, before ? &*before : nullptr, *here, after ? &*after : nullptr,
                      out_height, [&](int y, std::uint32_t color, std::uint32_t code) {
                        const std::size_t at = std::size_t(y) * to.pitch + std::size_t(x + c);
                        const bool was_empty = to.delta[at] == kEmptyWarped;
                        const std::uint32_t before = was_empty ? 0 : to.flags[at];
                        WarpTexel texel{to.color[at], to.delta[at] | before << 16};
                        blend(texel, color, code);
                        const bool empty = texel.code == kEmptyWarped;
                        to.color[at] = texel.color;
                        to.delta[at] = std::uint16_t(texel.code & 0xffff);
                        to.flags[at] = empty ? std::uint16_t(0) : std::uint16_t(texel.code >> 16);
                        counted.covered += was_empty && !empty;
                        counted.interpolated += to.flags[at] & 1;
                        counted.interpolated -= before & 1;
                      });
    }
  };
  for (int c = 0; c < columns; c += 16)
    for (const AxisWarp::Range& range : k.ranges)
      for (int at = 0; at < range.to - range.from; ++at)
        draw_edges(range.up ? range.from + at : range.to - 1 - at, c, shows_of(c), solid_of(c));
  return counted;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(do_columns);

std::size_t column_pass_scratch(int height, int out_height) {
  return std::size_t(kWarpStrip) * std::size_t(out_height) * sizeof(WarpTexel) +
         std::size_t(kWarpStrip / 16 * 2 * (height + 2)) * sizeof(std::uint16_t);
}

WarpedTexels column_pass(const AxisWarp& axis, const std::uint32_t* in, std::size_t block,
                         int height, int x, int columns, const WarpPlanes& to, int out_height,
                         std::byte* scratch) {
  return HWY_DYNAMIC_DISPATCH(do_columns)(axis, in, block, height, x, columns, to, out_height,
                                          scratch);
}

}  // namespace rilievo
#endif

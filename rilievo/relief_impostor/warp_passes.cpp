// How it is done fast: three steps, each simple for the processor. Which texels a piece covers is
// found for a vector of samples; the samples' indices are copied there one by one, in their order,
// without a branch; then each texel of the result gathers the two ends of its piece and
// interpolates. The second pass does so for kWarpStrip columns at once, whose indices stay in the
// first-level cache.
#include "rilievo/relief_impostor/warp_passes.h"

#include <algorithm>
#include <cstring>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/relief_impostor/warp_passes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using U16 = hn::Rebind<std::uint16_t, I>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;

constexpr std::uint16_t kNoPiece = 0xffff;

HWY_INLINE VU code_of(VU code) { return hn::And(code, hn::Set(U(), 0xffff)); }
HWY_INLINE VF as_float(VU value) { return hn::ConvertTo(F(), hn::BitCast(I(), value)); }
HWY_INLINE auto is_empty(VU code) { return hn::Eq(code, hn::Set(U(), kEmptyWarped)); }

// (a0 + a1 i) + q (b0 + b1 i)
HWY_INLINE VF position(const AxisWarp& k, VF i, VF q) {
  const F f;
  const VF a = hn::Add(hn::Set(f, k.a0), hn::Mul(hn::Set(f, k.a1), i));
  const VF b = hn::Add(hn::Set(f, k.b0), hn::Mul(hn::Set(f, k.b1), i));
  return hn::Add(a, hn::Mul(q, b));
}

// The texels [first, first + count) of [0, limit) of the pieces that begin at samples of index i;
// `missed` and a count of 0 or 1 if there is none.
struct Cells {
  VI first, count;
};
HWY_INLINE Cells cells_of(const AxisWarp& k, VF i, VU before, VU code, VU after, int limit,
                          VI missed) {
  const F f;
  const I n;
  const VF q = as_float(code), half = hn::Set(f, 0.5f);
  const VF p = position(k, i, q);
  const VF size = hn::Mul(half, hn::Add(hn::Set(f, k.a1), hn::Mul(q, hn::Set(f, k.b1))));
  const VF next = position(k, hn::Add(i, hn::Set(f, 1.0f)), as_float(after));
  const VF begin = hn::IfThenElse(hn::RebindMask(f, is_empty(before)), hn::Sub(p, size), p);
  const VF end = hn::IfThenElse(hn::RebindMask(f, is_empty(after)), hn::Add(p, size), next);
  const VF low = hn::Zero(f), high = hn::Set(f, float(limit));
  const auto cell = [&](VF at) {
    return hn::ConvertTo(n, hn::Min(hn::Max(hn::Add(at, half), low), high));
  };
  const VI first = cell(begin), count = hn::Sub(cell(end), first);
  const auto covers = hn::AndNot(hn::RebindMask(n, is_empty(code)), hn::Gt(count, hn::Zero(n)));
  return {hn::IfThenElse(covers, first, missed), hn::IfThenElseZero(covers, count)};
}

// The ends of the pieces of up to kWarpStrip texels: `b` follows `a`. Copied one by one: gather
// instructions are slower, on processors with mitigations several times.
struct Ends {
  HWY_ALIGN std::uint64_t a[kWarpStrip], b[kWarpStrip];
};
static_assert(sizeof(WarpTexel) == 8, "copied as one word");

HWY_INLINE void copy_ends(const WarpTexel* texels, std::ptrdiff_t step, const std::int32_t* at,
                          int count, Ends& ends) {
  for (int n = 0; n < count; ++n) {
    const WarpTexel* a = texels + at[n];
    std::memcpy(&ends.a[n], a, 8);
    std::memcpy(&ends.b[n], a + step, 8);
  }
}

// Two bytes of colours at a time.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE VU mix_pairs(VU a, VU b, VU t) {
  const U u;
  const VU sum = hn::Add(hn::Mul(a, hn::Sub(hn::Set(u, 256), t)), hn::Mul(b, t));
  return hn::And(hn::ShiftRight<8>(hn::Add(sum, hn::Set(u, 0x00800080))), hn::Set(u, 0x00ff00ff));
}
#else
HWY_INLINE VU mix_pairs(VU a, VU b, VU t) {
  const U u;
  const hn::Repartition<std::uint16_t, U> d;
  const auto weight_b = hn::BitCast(d, hn::Or(t, hn::ShiftLeft<16>(t)));
  const auto weight_a = hn::Sub(hn::Set(d, 256), weight_b);
  const auto sum =
      hn::Add(hn::Mul(hn::BitCast(d, a), weight_a), hn::Mul(hn::BitCast(d, b), weight_b));
  return hn::BitCast(u, hn::ShiftRight<8>(hn::Add(sum, hn::Set(d, 128))));
}
#endif

HWY_INLINE VU mix_bytes(VU a, VU b, VU t) {
  const VU low = hn::Set(U(), 0x00ff00ff);
  const VU even = mix_pairs(hn::And(a, low), hn::And(b, low), t);
  const VU odd =
      mix_pairs(hn::And(hn::ShiftRight<8>(a), low), hn::And(hn::ShiftRight<8>(b), low), t);
  return hn::Or(even, hn::ShiftLeft<8>(odd));
}

// Colour and code, with kInterpolatedBit, of the texels with these centres.
HWY_INLINE void between(const AxisWarp& k, const Ends& ends, int n, VF index, VF center, VU& color,
                        VU& code) {
  const F f;
  const U u;
  VU color_a, bits_a, color_b, bits_b;
  hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(ends.a + n), color_a, bits_a);
  hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(ends.b + n), color_b, bits_b);
  const VU code_a = code_of(bits_a), code_b = code_of(bits_b);
  const auto linked = hn::Not(hn::RebindMask(f, is_empty(code_b)));
  const VF qa = as_float(code_a), qb = as_float(code_b);
  const VF pa = position(k, index, qa);
  const VF pb = position(k, hn::Add(index, hn::Set(f, 1.0f)), qb);
  const VF from_a = hn::Sub(center, pa), to_b = hn::Sub(pb, center);
  const VF ratio = hn::IfThenElseZero(linked, hn::Div(from_a, hn::Sub(pb, pa)));
  const VF t = hn::Min(hn::Max(ratio, hn::Zero(f)), hn::Set(f, 1.0f));
  const VF half = hn::Set(f, 0.5f);
  const VI t8 = hn::ConvertTo(I(), hn::Add(hn::Mul(t, hn::Set(f, 256.0f)), half));
  color = mix_bytes(color_a, color_b, hn::BitCast(u, t8));
  // Where b shows nothing, its code counts with weight 0.
  const VF q = hn::Add(qa, hn::Mul(t, hn::Sub(qb, qa)));
  const VU mixed = hn::BitCast(u, hn::ConvertTo(I(), hn::Add(q, half)));
  const VF reach = hn::Set(f, k.reach);
  const auto far = hn::And(hn::Gt(hn::Abs(from_a), reach),
                           hn::Not(hn::And(linked, hn::Le(hn::Abs(to_b), reach))));
  const VU bit = hn::Set(u, kInterpolatedBit);
  const VU before =
      hn::And(hn::IfThenElse(hn::RebindMask(u, hn::Lt(t, half)), bits_a, bits_b), bit);
  code = hn::Or(mixed, hn::Or(before, hn::IfThenElseZero(hn::RebindMask(u, far), bit)));
}

// Writes the index of a piece to all of its texels. Most pieces cover one or two.
HWY_INLINE void write_piece(std::uint16_t* pieces, std::int32_t first, std::int32_t count,
                            std::ptrdiff_t step, std::uint16_t index) {
  std::uint16_t* to = pieces + first;
  *to = index;
  to[count > 1 ? step : 0] = index;
  for (std::int32_t n = 2; n < count; ++n) to[n * step] = index;
}

void do_row(const AxisWarp& k, const std::uint32_t* table, const WarpTexel* in, int width,
            WarpTexel* out, int out_width, std::byte* scratch) {
  const F f;
  const I n;
  const U u;
  const int lanes = int(hn::Lanes(f)), pitch = warp_pitch(width), out_pitch = warp_pitch(out_width);
  // One texel before the row, which shows nothing, and room for vectors.
  auto* texels = reinterpret_cast<WarpTexel*>(scratch) + 16;
  auto* codes = reinterpret_cast<std::uint32_t*>(texels + pitch) + 16;
  auto* first = reinterpret_cast<std::int32_t*>(codes + pitch);
  auto* count = first + pitch;
  auto* pieces = reinterpret_cast<std::uint16_t*>(count + pitch);
  codes[-1] = kEmptyWarped;
  int done = 0;
  for (; done < width; done += lanes) {
    VU color, level;
    hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(in + done), color, level);
    const VU code = hn::GatherIndex(u, table, hn::BitCast(n, level));
    hn::StoreInterleaved2(color, code, u, reinterpret_cast<std::uint32_t*>(texels + done));
    hn::StoreU(code, u, codes + done);
  }
  codes[done] = kEmptyWarped;
  texels[done] = {0, kEmptyWarped};
  const VI missed = hn::Set(n, out_pitch - 1);
  for (int i = 0; i < width; i += lanes) {
    const VF index = hn::ConvertTo(f, hn::Iota(n, i));
    const Cells cells = cells_of(k, index, hn::LoadU(u, codes + i - 1), hn::LoadU(u, codes + i),
                                 hn::LoadU(u, codes + i + 1), out_width, missed);
    hn::StoreU(cells.first, n, first + i);
    hn::StoreU(cells.count, n, count + i);
  }
  std::memset(pieces, 0xff, std::size_t(out_pitch) * sizeof(std::uint16_t));
  for (const AxisWarp::Range& range : k.ranges) {
    if (range.up)
      for (int i = range.from; i < range.to; ++i)
        write_piece(pieces, first[i], count[i], 1, std::uint16_t(i));
    else
      for (int i = range.to - 1; i >= range.from; --i)
        write_piece(pieces, first[i], count[i], 1, std::uint16_t(i));
  }
  const VF half = hn::Set(f, 0.5f);
  HWY_ALIGN std::int32_t at[kWarpStrip];
  Ends ends;
  for (int begin = 0; begin < out_width; begin += kWarpStrip) {
    const int columns = std::min(kWarpStrip, out_width - begin);
    for (int c = 0; c < columns; c += lanes) {
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), pieces + begin + c));
      hn::Store(hn::IfThenZeroElse(hn::Eq(piece, hn::Set(n, kNoPiece)), piece), n, at + c);
    }
    copy_ends(texels, 1, at, columns, ends);
    for (int c = 0; c < columns; c += lanes) {
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), pieces + begin + c));
      const VF center = hn::Add(hn::ConvertTo(f, hn::Iota(n, begin + c)), half);
      VU color, code;
      between(k, ends, c, hn::ConvertTo(f, piece), center, color, code);
      const auto empty = hn::RebindMask(u, hn::Eq(piece, hn::Set(n, kNoPiece)));
      hn::StoreInterleaved2(hn::IfThenZeroElse(empty, color),
                            hn::IfThenElse(empty, hn::Set(u, kEmptyWarped), code), u,
                            reinterpret_cast<std::uint32_t*>(out + begin + c));
    }
  }
}

WarpedTexels do_columns(const AxisWarp& k, const WarpTexel* in, int pitch, int height, int x,
                        int columns, std::uint32_t* color_plane, std::uint16_t* delta_plane,
                        std::size_t plane_pitch, int out_height, std::byte* scratch) {
  const F f;
  const I n;
  const U u;
  const int lanes = int(hn::Lanes(f));
  auto* codes = reinterpret_cast<std::uint32_t*>(scratch);  // height + 2 rows
  auto* pieces = reinterpret_cast<std::uint16_t*>(codes + (height + 2) * kWarpStrip);
  std::fill_n(codes, kWarpStrip, kEmptyWarped);
  std::fill_n(codes + (height + 1) * kWarpStrip, kWarpStrip, kEmptyWarped);
  std::memset(pieces, 0xff, std::size_t(out_height + 1) * kWarpStrip * sizeof(std::uint16_t));
  const WarpTexel* from = in + x;
  for (int v = 0; v < height; ++v)
    for (int c = 0; c < columns; c += lanes) {
      VU color, code;
      hn::LoadInterleaved2(
          u, reinterpret_cast<const std::uint32_t*>(from + std::ptrdiff_t(v) * pitch + c), color,
          code);
      hn::StoreU(code_of(code), u, codes + (v + 1) * kWarpStrip + c);
    }
  HWY_ALIGN std::int32_t first[kWarpStrip], count[kWarpStrip];
  const VI missed = hn::Set(n, out_height);
  const auto draw_row = [&](int v) {
    const std::uint32_t* row = codes + (v + 1) * kWarpStrip;
    const VF index = hn::Set(f, float(v));
    for (int c = 0; c < columns; c += lanes) {
      const Cells cells =
          cells_of(k, index, hn::LoadU(u, row - kWarpStrip + c), hn::LoadU(u, row + c),
                   hn::LoadU(u, row + kWarpStrip + c), out_height, missed);
      hn::StoreU(hn::Mul(cells.first, hn::Set(n, kWarpStrip)), n, first + c);
      hn::StoreU(cells.count, n, count + c);
    }
    for (int c = 0; c < columns; ++c)
      write_piece(pieces + c, first[c], count[c], kWarpStrip, std::uint16_t(v));
  };
  for (const AxisWarp::Range& range : k.ranges) {
    if (range.up)
      for (int v = range.from; v < range.to; ++v) draw_row(v);
    else
      for (int v = range.to - 1; v >= range.from; --v) draw_row(v);
  }
  WarpedTexels counted;
  HWY_ALIGN std::uint32_t colors[16];
  HWY_ALIGN std::uint16_t deltas[16];
  HWY_ALIGN std::int32_t at[kWarpStrip];
  Ends ends;
  for (int y = 0; y < out_height; ++y) {
    const VF center = hn::Set(f, float(y) + 0.5f);
    const std::uint16_t* row = pieces + y * kWarpStrip;
    for (int c = 0; c < columns; c += lanes) {
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), row + c));
      const VI to = hn::Add(hn::Mul(piece, hn::Set(n, pitch)), hn::Iota(n, c));
      hn::Store(hn::IfThenZeroElse(hn::Eq(piece, hn::Set(n, kNoPiece)), to), n, at + c);
    }
    // The row after the last shows nothing.
    copy_ends(from, pitch, at, columns, ends);
    for (int c = 0; c < columns; c += lanes) {
      const auto inside = hn::FirstN(n, std::size_t(columns - c));
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), row + c));
      const auto none = hn::Or(hn::Eq(piece, hn::Set(n, kNoPiece)), hn::Not(inside));
      std::uint32_t* color_to = color_plane + std::size_t(y) * plane_pitch + std::size_t(x + c);
      std::uint16_t* delta_to = delta_plane + std::size_t(y) * plane_pitch + std::size_t(x + c);
      VU mixed_color, mixed;
      between(k, ends, c, hn::ConvertTo(f, piece), center, mixed_color, mixed);
      const auto empty = hn::RebindMask(u, none);
      const VU color = hn::IfThenZeroElse(empty, mixed_color);
      const VU code = hn::IfThenElse(empty, hn::Set(u, kEmptyWarped), mixed);
      const auto bit = hn::Set(u, kInterpolatedBit);
      counted.covered += std::size_t(lanes) - hn::CountTrue(n, none);
      counted.interpolated += hn::CountTrue(u, hn::Eq(hn::And(code, bit), bit));
      const auto delta = hn::DemoteTo(U16(), hn::BitCast(n, code_of(code)));
      if (c + lanes <= columns) {
        hn::StoreU(color, u, color_to);
        hn::StoreU(delta, U16(), delta_to);
      } else {
        // The rest by way of memory of our own: beyond it lies what others write.
        hn::StoreU(color, u, colors);
        hn::StoreU(delta, U16(), deltas);
        std::copy_n(colors, columns - c, color_to);
        std::copy_n(deltas, columns - c, delta_to);
      }
    }
  }
  return counted;
}

void do_table(const LevelCodes& k, std::uint32_t* table) {
  const F f;
  const I n;
  const U u;
  const VF most = hn::Set(f, float(kEmptyWarped - 1));
  for (std::uint32_t level = 0; level <= kEmptyLevel; level += std::uint32_t(hn::Lanes(f))) {
    const VF at = hn::ConvertTo(f, hn::Iota(n, std::int32_t(level)));
    const VF nearness = hn::Div(hn::Add(hn::Set(f, k.r0), hn::Mul(hn::Set(f, k.r1), at)),
                                hn::Add(hn::Set(f, k.c0), hn::Mul(hn::Set(f, k.c1), at)));
    const VF code = hn::Add(hn::Set(f, k.m0), hn::Mul(hn::Set(f, k.m1), nearness));
    const VF rounded = hn::Min(hn::Max(hn::Add(code, hn::Set(f, 0.5f)), hn::Zero(f)), most);
    hn::StoreU(hn::BitCast(u, hn::ConvertTo(n, rounded)), u, table + level);
  }
  table[kEmptyLevel] = kEmptyWarped;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(do_row);
HWY_EXPORT(do_columns);
HWY_EXPORT(do_table);

std::size_t row_pass_scratch(int width, int out_width) {
  return std::size_t(warp_pitch(width) + 16) * 20 + 64 +
         std::size_t(warp_pitch(out_width)) * sizeof(std::uint16_t);
}

std::size_t column_pass_scratch(int height, int out_height) {
  return std::size_t(kWarpStrip) * (std::size_t(height + 2) * 4 + std::size_t(out_height + 1) * 2);
}

void row_pass(const AxisWarp& axis, const std::uint32_t* table, const WarpTexel* in, int width,
              WarpTexel* out, int out_width, std::byte* scratch) {
  HWY_DYNAMIC_DISPATCH(do_row)(axis, table, in, width, out, out_width, scratch);
}

WarpedTexels column_pass(const AxisWarp& axis, const WarpTexel* in, int pitch, int height, int x,
                         int columns, std::uint32_t* color, std::uint16_t* delta,
                         std::size_t plane_pitch, int out_height, std::byte* scratch) {
  return HWY_DYNAMIC_DISPATCH(do_columns)(axis, in, pitch, height, x, columns, color, delta,
                                          plane_pitch, out_height, scratch);
}

void level_table(const LevelCodes& codes, std::uint32_t* table) {
  HWY_DYNAMIC_DISPATCH(do_table)(codes, table);
}

}  // namespace rilievo
#endif

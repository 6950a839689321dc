// How it is done fast: three steps, each simple for the processor. Which texels a piece covers is
// found for a vector of samples; the samples' indices are copied there one by one, in their order,
// without a branch; then each texel of the result gathers the two ends of its piece and
// interpolates. The second pass does so for kWarpStrip columns at once, whose indices stay in the
// first-level cache. Silhouettes are few: their pieces are found by bits and drawn one by one.
#include "rilievo/relief_impostor/warp_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
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

// The texels [first, first + count) of [0, limit) of the pieces of solid surface that begin at
// samples of index i; `missed` and a count of 0 or 1 if there is none.
struct Cells {
  VI first, count;
};
HWY_INLINE Cells cells_of(const AxisWarp& k, VF i, VU code, VU after, int limit, VI missed) {
  const F f;
  const I n;
  const VF half = hn::Set(f, 0.5f);
  const VF begin = position(k, i, as_float(code));
  const VF end = position(k, hn::Add(i, hn::Set(f, 1.0f)), as_float(after));
  const VF low = hn::Zero(f), high = hn::Set(f, float(limit));
  const auto cell = [&](VF at) {
    return hn::ConvertTo(n, hn::Min(hn::Max(hn::Add(at, half), low), high));
  };
  const VI first = cell(begin), count = hn::Sub(cell(end), first);
  const auto none = hn::RebindMask(n, hn::Or(is_empty(code), is_empty(after)));
  const auto covers = hn::AndNot(none, hn::Gt(count, hn::Zero(n)));
  return {hn::IfThenElse(covers, first, missed), hn::IfThenElseZero(covers, count)};
}

// The ends of the pieces of up to kWarpStrip texels, both of a piece in turn. Copied one by one:
// gather instructions are slower, on processors with mitigations several times.
struct Ends {
  HWY_ALIGN std::uint32_t words[4 * kWarpStrip];
};
static_assert(sizeof(WarpTexel) == 8, "copied as one word");

// `step`: from a piece's one end to the other.
HWY_INLINE void copy_ends(const WarpTexel* texels, std::ptrdiff_t step, const std::int32_t* at,
                          int from, int to, Ends& ends) {
  for (int n = from; n < to; ++n) {
    const WarpTexel* a = texels + at[n];
    if (step == 1) {
      std::memcpy(ends.words + 4 * n, a, 16);
    } else {
      std::memcpy(ends.words + 4 * n, a, 8);
      std::memcpy(ends.words + 4 * n + 2, a + step, 8);
    }
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
  hn::LoadInterleaved4(u, ends.words + 4 * n, color_a, bits_a, color_b, bits_b);
  const VF qa = as_float(code_of(bits_a)), qb = as_float(code_of(bits_b));
  const VF pa = position(k, index, qa);
  const VF pb = position(k, hn::Add(index, hn::Set(f, 1.0f)), qb);
  const VF from_a = hn::Sub(center, pa), to_b = hn::Sub(pb, center);
  const VF t = hn::Min(hn::Max(hn::Div(from_a, hn::Sub(pb, pa)), hn::Zero(f)), hn::Set(f, 1.0f));
  const VF half = hn::Set(f, 0.5f);
  const VI t8 = hn::ConvertTo(I(), hn::Add(hn::Mul(t, hn::Set(f, 256.0f)), half));
  color = mix_bytes(color_a, color_b, hn::BitCast(u, t8));
  const VF q = hn::Add(qa, hn::Mul(t, hn::Sub(qb, qa)));
  const VU mixed = hn::BitCast(u, hn::ConvertTo(I(), hn::Add(q, half)));
  const VF reach = hn::Set(f, k.reach);
  const auto far = hn::And(hn::Gt(hn::Abs(from_a), reach), hn::Gt(hn::Abs(to_b), reach));
  const auto torn = hn::Gt(hn::Sub(pb, pa), hn::Set(f, kTear));
  const VU before = hn::And(hn::IfThenElse(hn::RebindMask(u, hn::Lt(t, half)), bits_a, bits_b),
                            hn::Set(u, kInterpolatedBit | kTornBit));
  const auto bit = [&](auto where, std::uint32_t value) {
    return hn::IfThenElseZero(hn::RebindMask(u, where), hn::Set(u, value));
  };
  code = hn::Or(hn::Or(mixed, before), hn::Or(bit(far, kInterpolatedBit), bit(torn, kTornBit)));
}

// Is a texel opaque?
HWY_INLINE auto is_opaque(VU color) { return hn::Eq(hn::ShiftRight<24>(color), hn::Set(U(), 255)); }

// The bits of a mask.
template <class Mask>
HWY_INLINE std::uint64_t bits_of(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(U(), mask, bytes);
  std::uint64_t bits = 0;
  std::memcpy(&bits, bytes, 8);
  return bits & ((std::uint64_t(1) << hn::Lanes(U())) - 1);
}

// --- Silhouettes, one at a time.

std::uint32_t mix_colors(std::uint32_t a, std::uint32_t b, std::uint32_t t) {
  const auto pair = [&](std::uint32_t from, std::uint32_t to) {
    const std::uint32_t low = 0x00ff00ff;
    return ((from & low) * (256 - t) + (to & low) * t + 0x00800080) >> 8 & low;
  };
  return pair(a, b) | pair(a >> 8, b >> 8) << 8;
}

// Premultiplied `front` before `behind`.
std::uint32_t over(std::uint32_t front, std::uint32_t behind) {
  const std::uint32_t through = 255 - (front >> 24);
  std::uint32_t sum = 0;
  for (int c = 0; c < 32; c += 8)
    sum |= std::min(255u, (front >> c & 255) + ((behind >> c & 255) * through + 127) / 255) << c;
  return sum;
}

// Adds a texel to what is there already.
void blend(WarpTexel& to, std::uint32_t color, std::uint32_t code) {
  if (color >> 24 < kFaintAlpha) return;
  const bool empty = to.code == kEmptyWarped;
  if (empty || (code & 0xffff) <= (to.code & 0xffff)) {
    to.color = empty ? color : over(color, to.color);
    if (empty || color >> 24 >= 128) to.code = code;
  } else if (to.color >> 24 < 255) {
    if (to.color >> 24 < 128) to.code = code;
    to.color = over(to.color, color);
  }
}

// Draws the pieces that begin at sample `a` of index i, and the one that ends there if nothing is
// before it. `put(x, color, code)` blends a texel.
template <class Put>
void draw_silhouette(const AxisWarp& k, int i, const WarpTexel* before, const WarpTexel& a,
                     const WarpTexel* after, int limit, Put&& put) {
  const auto at = [&](int index, std::uint32_t code) {
    return (k.a0 + k.a1 * float(index)) + float(code) * (k.b0 + k.b1 * float(index));
  };
  const auto cell = [&](float x) { return int(std::clamp(x + 0.5f, 0.0f, float(limit))); };
  const std::uint32_t qa = a.code & 0xffff;
  const float p = at(i, qa), size = k.a1 + float(qa) * k.b1;
  const auto fade = [&](float from, float to) {
    for (int x = cell(from), end = cell(to); x < end; ++x) {
      const float t = std::min(std::abs(float(x) + 0.5f - p) / size, 1.0f);
      put(x, mix_colors(a.color, 0, std::uint32_t(t * 256.0f + 0.5f)), a.code);
    }
  };
  if (!before && size > 0) fade(p - size, p);
  if (!after) {
    if (size > 0) fade(p, p + size);
  } else if (a.color >> 24 < 255 || after->color >> 24 < 255) {
    const std::uint32_t qb = after->code & 0xffff;
    const float next = at(i + 1, qb);
    for (int x = cell(p), end = cell(next); x < end; ++x) {
      const float center = float(x) + 0.5f;
      const float t = std::clamp((center - p) / (next - p), 0.0f, 1.0f);
      const auto q = std::uint32_t(float(qa) + t * (float(qb) - float(qa)) + 0.5f);
      const bool far = std::abs(center - p) > k.reach && std::abs(next - center) > k.reach;
      const std::uint32_t before_bits =
          (t < 0.5f ? a : *after).code & (kInterpolatedBit | kTornBit);
      const std::uint32_t bits =
          before_bits | (far ? kInterpolatedBit : 0) | (next - p > kTear ? kTornBit : 0);
      put(x, mix_colors(a.color, after->color, std::uint32_t(t * 256.0f + 0.5f)), q | bits);
    }
  }
}

// Writes the index of a piece to all of its texels. Most pieces cover one or two.
HWY_INLINE void write_piece(std::uint16_t* pieces, std::int32_t first, std::int32_t count,
                            std::ptrdiff_t step, std::uint16_t index) {
  std::uint16_t* to = pieces + first;
  *to = index;
  to[count > 1 ? step : 0] = index;
  for (std::int32_t n = 2; n < count; ++n) to[n * step] = index;
}

// Calls `draw` with each index whose bit is set, in the order of the pieces.
template <class Word, class Draw>
void for_bits(const AxisWarp& k, Word&& word_of, Draw&& draw) {
  for (const AxisWarp::Range& range : k.ranges) {
    if (range.from >= range.to) continue;
    const int first = range.from / 64, last = (range.to - 1) / 64;
    for (int n = 0; n <= last - first; ++n) {
      const int word = range.up ? first + n : last - n;
      std::uint64_t bits = word_of(word);
      if (word == first) bits &= ~std::uint64_t(0) << (range.from % 64);
      if (word == last) bits &= ~std::uint64_t(0) >> (63 - (range.to - 1) % 64);
      while (bits) {
        const int bit = range.up ? std::countr_zero(bits) : 63 - std::countl_zero(bits);
        bits &= ~(std::uint64_t(1) << bit);
        draw(64 * word + bit);
      }
    }
  }
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
  // By sample, a bit: does it show something, and is it opaque? A word beyond each end.
  const int words = (width + 63) / 64 + 2;
  auto* shows = reinterpret_cast<std::uint64_t*>(count + pitch) + 1;
  auto* solid = shows + words;
  auto* pieces = reinterpret_cast<std::uint16_t*>(solid + words - 1);
  std::fill(shows - 1, shows - 1 + 2 * words, 0);
  int done = 0;
  for (; done < width; done += lanes) {
    VU color, level;
    hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(in + done), color, level);
    const VU code = hn::GatherIndex(u, table, hn::BitCast(n, level));
    hn::StoreInterleaved2(color, code, u, reinterpret_cast<std::uint32_t*>(texels + done));
    const auto opaque = is_opaque(color);
    hn::StoreU(hn::IfThenElse(opaque, code, hn::Set(u, kEmptyWarped)), u, codes + done);
    const auto there = hn::Not(is_empty(code));
    shows[done / 64] |= bits_of(there) << (done % 64);
    solid[done / 64] |= bits_of(hn::And(there, opaque)) << (done % 64);
  }
  codes[done] = kEmptyWarped;
  texels[done] = {0, kEmptyWarped};
  const auto fill_empty = [&](int from, int to) {
    for (int x = from; x < to; ++x) out[x] = {0, kEmptyWarped};
  };
  std::uint64_t any = 0;
  for (int word = 0; word < words - 2; ++word) any |= shows[word];
  if (!any) {
    fill_empty(0, out_width);
    return;
  }
  const VI missed = hn::Set(n, out_pitch - 1);
  for (int i = 0; i < width; i += lanes) {
    const VF index = hn::ConvertTo(f, hn::Iota(n, i));
    const Cells cells =
        cells_of(k, index, hn::LoadU(u, codes + i), hn::LoadU(u, codes + i + 1), out_width, missed);
    hn::StoreU(cells.first, n, first + i);
    hn::StoreU(cells.count, n, count + i);
  }
  std::memset(pieces, 0xff, std::size_t(out_pitch) * sizeof(std::uint16_t));
  const auto write = [&](int i) { write_piece(pieces, first[i], count[i], 1, std::uint16_t(i)); };
  // Of 64 samples at a time, those that have something opaque.
  for (const AxisWarp::Range& range : k.ranges) {
    if (range.from >= range.to) continue;
    const int low = range.from / 64, high = (range.to - 1) / 64;
    for (int step = 0; step <= high - low; ++step) {
      const int word = range.up ? low + step : high - step;
      if (!solid[word]) continue;
      const int from = std::max(range.from, 64 * word), to = std::min(range.to, 64 * word + 64);
      if (range.up)
        for (int i = from; i < to; ++i) write(i);
      else
        for (int i = to - 1; i >= from; --i) write(i);
    }
  }
  const VF half = hn::Set(f, 0.5f);
  HWY_ALIGN std::int32_t at[kWarpStrip];
  bool empty[kWarpStrip];
  Ends ends;
  for (int begin = 0; begin < out_width; begin += kWarpStrip) {
    const int columns = std::min(kWarpStrip, out_width - begin);
    for (int c = 0; c < columns; c += lanes) {
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), pieces + begin + c));
      const auto none = hn::Eq(piece, hn::Set(n, kNoPiece));
      hn::Store(hn::IfThenZeroElse(none, piece), n, at + c);
      empty[c / lanes] = hn::AllTrue(n, none);
      if (!empty[c / lanes]) copy_ends(texels, 1, at, c, c + lanes, ends);
    }
    for (int c = 0; c < columns; c += lanes) {
      auto* to = reinterpret_cast<std::uint32_t*>(out + begin + c);
      if (empty[c / lanes]) {
        hn::StoreInterleaved2(hn::Zero(u), hn::Set(u, kEmptyWarped), u, to);
        continue;
      }
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), pieces + begin + c));
      const VF center = hn::Add(hn::ConvertTo(f, hn::Iota(n, begin + c)), half);
      VU color, code;
      between(k, ends, c, hn::ConvertTo(f, piece), center, color, code);
      const auto none = hn::RebindMask(u, hn::Eq(piece, hn::Set(n, kNoPiece)));
      hn::StoreInterleaved2(hn::IfThenZeroElse(none, color),
                            hn::IfThenElse(none, hn::Set(u, kEmptyWarped), code), u, to);
    }
  }
  const auto draw_edge = [&](int i) {
    const auto beside = [&](int j) { return (shows[j >> 6] >> (j & 63) & 1) != 0; };
    draw_silhouette(
        k, i, i > 0 && beside(i - 1) ? texels + i - 1 : nullptr, texels[i],
        beside(i + 1) ? texels + i + 1 : nullptr, out_width,
        [&](int x, std::uint32_t color, std::uint32_t code) { blend(out[x], color, code); });
  };
  const auto edges = [&](int word) {
    const std::uint64_t here = solid[word], left = here << 1 | solid[word - 1] >> 63,
                        right = here >> 1 | solid[word + 1] << 63;
    return shows[word] & ~(here & left & right);
  };
  for_bits(k, edges, draw_edge);
}

WarpedTexels do_columns(const AxisWarp& k, const WarpTexel* in, int pitch, int height, int x,
                        int columns, const WarpPlanes& to, int out_height, std::byte* scratch) {
  const F f;
  const I n;
  const U u;
  const int lanes = int(hn::Lanes(f));
  auto* codes = reinterpret_cast<std::uint32_t*>(scratch);  // height + 2 rows
  // A bit for each column, by row: does it show something, and is it opaque?
  auto* shows = reinterpret_cast<std::uint64_t*>(codes + (height + 2) * kWarpStrip) + 1;
  auto* solid = shows + height + 2;
  auto* pieces = reinterpret_cast<std::uint16_t*>(solid + height + 1);
  std::fill(shows - 1, shows - 1 + 2 * (height + 2), 0);
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
      const auto opaque = is_opaque(color);
      const VU plain = code_of(code);
      hn::StoreU(hn::IfThenElse(opaque, plain, hn::Set(u, kEmptyWarped)), u,
                 codes + (v + 1) * kWarpStrip + c);
      const auto there =
          hn::AndNot(is_empty(plain), hn::FirstN(u, std::size_t(std::max(0, columns - c))));
      shows[v] |= bits_of(there) << c;
      solid[v] |= bits_of(hn::And(there, opaque)) << c;
    }
  HWY_ALIGN std::int32_t first[kWarpStrip], count[kWarpStrip];
  const VI missed = hn::Set(n, out_height);
  const auto draw_row = [&](int v) {
    if (!solid[v]) return;
    const std::uint32_t* row = codes + (v + 1) * kWarpStrip;
    const VF index = hn::Set(f, float(v));
    for (int c = 0; c < columns; c += lanes) {
      const Cells cells = cells_of(k, index, hn::LoadU(u, row + c),
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
  HWY_ALIGN std::uint16_t deltas[16], bits[16];
  HWY_ALIGN std::int32_t at[kWarpStrip];
  bool empty[kWarpStrip];
  Ends ends;
  for (int y = 0; y < out_height; ++y) {
    const VF center = hn::Set(f, float(y) + 0.5f);
    const std::uint16_t* row = pieces + y * kWarpStrip;
    for (int c = 0; c < columns; c += lanes) {
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), row + c));
      const auto none = hn::Eq(piece, hn::Set(n, kNoPiece));
      const VI to = hn::Add(hn::Mul(piece, hn::Set(n, pitch)), hn::Iota(n, c));
      hn::Store(hn::IfThenZeroElse(none, to), n, at + c);
      // The row after the last shows nothing.
      empty[c / lanes] = hn::AllTrue(n, none);
      if (!empty[c / lanes]) copy_ends(from, pitch, at, c, c + lanes, ends);
    }
    for (int c = 0; c < columns; c += lanes) {
      if (empty[c / lanes] && c + lanes <= columns) {
        const std::size_t at_texel = std::size_t(y) * to.pitch + std::size_t(x + c);
        hn::StoreU(hn::Zero(u), u, to.color + at_texel);
        hn::StoreU(hn::Set(U16(), kNoPiece), U16(), to.delta + at_texel);
        hn::StoreU(hn::Zero(U16()), U16(), to.flags + at_texel);
        continue;
      }
      const auto inside = hn::FirstN(n, std::size_t(columns - c));
      const VI piece = hn::PromoteTo(n, hn::LoadU(U16(), row + c));
      const auto none = hn::Or(hn::Eq(piece, hn::Set(n, kNoPiece)), hn::Not(inside));
      const std::size_t at_texel = std::size_t(y) * to.pitch + std::size_t(x + c);
      VU mixed_color, mixed;
      between(k, ends, c, hn::ConvertTo(f, piece), center, mixed_color, mixed);
      const auto empty = hn::RebindMask(u, none);
      const VU color = hn::IfThenZeroElse(empty, mixed_color);
      const VU code = hn::IfThenElse(empty, hn::Set(u, kEmptyWarped), mixed);
      const auto bit = hn::Set(u, kInterpolatedBit);
      counted.covered += std::size_t(lanes) - hn::CountTrue(n, none);
      counted.interpolated += hn::CountTrue(u, hn::Eq(hn::And(code, bit), bit));
      const auto delta = hn::DemoteTo(U16(), hn::BitCast(n, code_of(code)));
      const auto flags = hn::DemoteTo(U16(), hn::BitCast(n, hn::ShiftRight<16>(code)));
      if (c + lanes <= columns) {
        hn::StoreU(color, u, to.color + at_texel);
        hn::StoreU(delta, U16(), to.delta + at_texel);
        hn::StoreU(flags, U16(), to.flags + at_texel);
      } else {
        // The rest by way of memory of our own: beyond it lies what others write.
        hn::StoreU(color, u, colors);
        hn::StoreU(delta, U16(), deltas);
        hn::StoreU(flags, U16(), bits);
        std::copy_n(colors, columns - c, to.color + at_texel);
        std::copy_n(deltas, columns - c, to.delta + at_texel);
        std::copy_n(bits, columns - c, to.flags + at_texel);
      }
    }
  }
  const auto draw_edges = [&](int v) {
    const std::uint64_t edges = shows[v] & ~(solid[v - 1] & solid[v] & solid[v + 1]);
    for (std::uint64_t bits = edges; bits; bits &= bits - 1) {
      const int c = std::countr_zero(bits);
      const auto texel = [&](int row) -> const WarpTexel* {
        return shows[row] >> c & 1 ? from + std::ptrdiff_t(row) * pitch + c : nullptr;
      };
      draw_silhouette(k, v, texel(v - 1), *texel(v), texel(v + 1), out_height,
                      [&](int y, std::uint32_t color, std::uint32_t code) {
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
  for (const AxisWarp::Range& range : k.ranges) {
    if (range.up)
      for (int v = range.from; v < range.to; ++v) draw_edges(v);
    else
      for (int v = range.to - 1; v >= range.from; --v) draw_edges(v);
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
         std::size_t((width + 63) / 64 + 2) * 2 * sizeof(std::uint64_t) +
         std::size_t(warp_pitch(out_width)) * sizeof(std::uint16_t);
}

std::size_t column_pass_scratch(int height, int out_height) {
  return std::size_t(kWarpStrip) * (std::size_t(height + 2) * 4 + std::size_t(out_height + 1) * 2) +
         std::size_t(height + 2) * 2 * sizeof(std::uint64_t);
}

void row_pass(const AxisWarp& axis, const std::uint32_t* table, const WarpTexel* in, int width,
              WarpTexel* out, int out_width, std::byte* scratch) {
  HWY_DYNAMIC_DISPATCH(do_row)(axis, table, in, width, out, out_width, scratch);
}

WarpedTexels column_pass(const AxisWarp& axis, const WarpTexel* in, int pitch, int height, int x,
                         int columns, const WarpPlanes& to, int out_height, std::byte* scratch) {
  return HWY_DYNAMIC_DISPATCH(do_columns)(axis, in, pitch, height, x, columns, to, out_height,
                                          scratch);
}

void level_table(const LevelCodes& codes, std::uint32_t* table) {
  HWY_DYNAMIC_DISPATCH(do_table)(codes, table);
}

}  // namespace rilievo
#endif

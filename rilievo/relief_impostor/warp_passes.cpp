// How it is done fast: a vector of samples beside each other and of those after them are the ends
// of as many pieces. Most pieces cover one texel or two, whose interpolation needs no gathering
// then; the results are copied to where they belong one by one, in the pieces' order. Longer pieces
// are interpolated one by one, a vector of texels at once. The second pass does so for kWarpStrip
// columns at once. Silhouettes are few: their pieces are found by bits and drawn one by one.
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

// Pieces of surface: both ends, and where they are.
struct Pieces {
  VU color_a, bits_a, color_b, bits_b;
  VF qa, qb, pa, pb;
};
HWY_INLINE Pieces pieces_of(const AxisWarp& k, VF i, VU color_a, VU bits_a, VU color_b, VU bits_b) {
  const VF qa = as_float(code_of(bits_a)), qb = as_float(code_of(bits_b));
  const VF after = hn::Add(i, hn::Set(F(), 1.0f));
  return {color_a, bits_a, color_b, bits_b, qa, qb, position(k, i, qa), position(k, after, qb)};
}

static_assert(sizeof(WarpTexel) == 8, "copied as one word");

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

// Colour and code, with kInterpolatedBit, of the texels with these centres, one of each piece.
HWY_INLINE void between(const AxisWarp& k, const Pieces& of, VF center, VU& color, VU& code) {
  const F f;
  const U u;
  const auto& [color_a, bits_a, color_b, bits_b, qa, qb, pa, pb] = of;
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

// The first two texels of pieces that begin at samples beside each other, and where they belong.
struct FirstTexels {
  HWY_ALIGN WarpTexel one[16], two[16];
  HWY_ALIGN std::int32_t first[16], second[16], count[16];
  bool any = false, any_two = false, any_long = false;
};

// Of the `valid` ones, within [0, limit). Texel x belongs to place `step` x + `beside`; what covers
// nothing, to `missed`.
HWY_INLINE void find_texels(const AxisWarp& k, const Pieces& pieces, hn::Mask<I> valid, int limit,
                            int step, VI beside, VI missed, FirstTexels& to) {
  const F f;
  const I n;
  const U u;
  const VF half = hn::Set(f, 0.5f), low = hn::Zero(f), high = hn::Set(f, float(limit));
  const auto cell = [&](VF at) {
    return hn::ConvertTo(n, hn::Min(hn::Max(hn::Add(at, half), low), high));
  };
  const VI first = cell(pieces.pa), count = hn::Sub(cell(pieces.pb), first);
  const auto covers = hn::And(valid, hn::Gt(count, hn::Zero(n)));
  to.any = !hn::AllFalse(n, covers);
  if (!to.any) return;
  const VI place = hn::Add(hn::Mul(first, hn::Set(n, step)), beside);
  hn::Store(hn::IfThenElse(covers, place, missed), n, to.first);
  VU color, code;
  const VF center = hn::Add(hn::ConvertTo(f, first), half);
  between(k, pieces, center, color, code);
  hn::StoreInterleaved2(color, code, u, reinterpret_cast<std::uint32_t*>(to.one));
  const auto two = hn::And(covers, hn::Gt(count, hn::Set(n, 1)));
  to.any_two = !hn::AllFalse(n, two);
  to.any_long = false;
  if (!to.any_two) return;
  hn::Store(hn::IfThenElse(two, hn::Add(place, hn::Set(n, step)), missed), n, to.second);
  between(k, pieces, hn::Add(center, hn::Set(f, 1.0f)), color, code);
  hn::StoreInterleaved2(color, code, u, reinterpret_cast<std::uint32_t*>(to.two));
  to.any_long = !hn::AllFalse(n, hn::And(two, hn::Gt(count, hn::Set(n, 2))));
  if (to.any_long) hn::Store(hn::IfThenElseZero(covers, count), n, to.count);
}

// `count` texels of one piece from texel x on; `to` is the place of texel 0.
HWY_INLINE void draw_long(const AxisWarp& k, int i, const WarpTexel& a, const WarpTexel& b, int x,
                          int count, WarpTexel* to, int step) {
  const F f;
  const U u;
  const int lanes = int(hn::Lanes(f));
  const Pieces piece = pieces_of(k, hn::Set(f, float(i)), hn::Set(u, a.color), hn::Set(u, a.code),
                                 hn::Set(u, b.color), hn::Set(u, b.code));
  HWY_ALIGN WarpTexel texels[16];
  for (int end = x + count; x < end; x += lanes) {
    const VF center = hn::Add(hn::ConvertTo(f, hn::Iota(I(), x)), hn::Set(f, 0.5f));
    VU color, code;
    between(k, piece, center, color, code);
    hn::StoreInterleaved2(color, code, u, reinterpret_cast<std::uint32_t*>(texels));
    for (int n = 0; n < std::min(lanes, end - x); ++n) to[(x + n) * step] = texels[n];
  }
}

// Copies texels of `lanes` pieces to their places, in order; `draw_rest(lane)` draws those of a
// long piece but its first two.
template <class Rest>
HWY_INLINE void copy_texels(const FirstTexels& of, int from, int to, bool up, WarpTexel* out,
                            Rest&& draw_rest) {
  const auto copy_all = [&](auto&& copy) {
    if (up)
      for (int l = from; l < to; ++l) copy(l);
    else
      for (int l = to - 1; l >= from; --l) copy(l);
  };
  if (!of.any) return;
  if (!of.any_two) {
    copy_all([&](int l) { out[of.first[l]] = of.one[l]; });
  } else if (!of.any_long) {
    copy_all([&](int l) {
      out[of.first[l]] = of.one[l];
      out[of.second[l]] = of.two[l];
    });
  } else {
    copy_all([&](int l) {
      out[of.first[l]] = of.one[l];
      out[of.second[l]] = of.two[l];
      if (of.count[l] > 2) draw_rest(l);
    });
  }
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
  auto* colors = reinterpret_cast<std::uint32_t*>(scratch);
  auto* codes = colors + pitch;  // of what is not opaque: empty
  // By sample, a bit: does it show something, and is it opaque? A word beyond each end.
  const int words = (width + 63) / 64 + 2;
  auto* shows = reinterpret_cast<std::uint64_t*>(codes + pitch) + 1;
  auto* solid = shows + words;
  std::fill(shows - 1, shows - 1 + 2 * words, 0);
  int done = 0;
  for (; done < width; done += lanes) {
    VU color, level;
    hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(in + done), color, level);
    const VU code = hn::GatherIndex(u, table, hn::BitCast(n, level));
    hn::StoreU(color, u, colors + done);
    const auto opaque = is_opaque(color);
    hn::StoreU(hn::IfThenElse(opaque, code, hn::Set(u, kEmptyWarped)), u, codes + done);
    const auto there = hn::Not(is_empty(code));
    shows[done / 64] |= bits_of(there) << (done % 64);
    solid[done / 64] |= bits_of(hn::And(there, opaque)) << (done % 64);
  }
  codes[done] = kEmptyWarped, colors[done] = 0;
  for (int x = 0; x < out_width; x += lanes)
    hn::StoreInterleaved2(hn::Zero(u), hn::Set(u, kEmptyWarped), u,
                          reinterpret_cast<std::uint32_t*>(out + x));
  std::uint64_t any = 0;
  for (int word = 0; word < words - 2; ++word) any |= shows[word];
  if (!any) return;
  const VI missed = hn::Set(n, out_pitch - 1);
  FirstTexels texels;
  const auto draw_pieces = [&](const AxisWarp::Range& range, int i) {
    const VU code_a = hn::LoadU(u, codes + i), code_b = hn::LoadU(u, codes + i + 1);
    const auto valid = hn::Not(hn::RebindMask(n, hn::Or(is_empty(code_a), is_empty(code_b))));
    if (hn::AllFalse(n, valid)) return;
    const Pieces pieces = pieces_of(k, hn::ConvertTo(f, hn::Iota(n, i)), hn::LoadU(u, colors + i),
                                    code_a, hn::LoadU(u, colors + i + 1), code_b);
    find_texels(k, pieces, valid, out_width, 1, hn::Zero(n), missed, texels);
    copy_texels(texels, std::max(range.from - i, 0), std::min(range.to - i, lanes), range.up, out,
                [&](int l) {
                  draw_long(k, i + l, {colors[i + l], codes[i + l]},
                            {colors[i + l + 1], codes[i + l + 1]}, texels.first[l] + 2,
                            texels.count[l] - 2, out, 1);
                });
  };
  for (const AxisWarp::Range& range : k.ranges) {
    if (range.from >= range.to) continue;
    const int low = range.from / lanes * lanes, high = (range.to - 1) / lanes * lanes;
    if (range.up)
      for (int i = low; i <= high; i += lanes) draw_pieces(range, i);
    else
      for (int i = high; i >= low; i -= lanes) draw_pieces(range, i);
  }
  const auto draw_edge = [&](int i) {
    const auto beside = [&](int j) { return (shows[j >> 6] >> (j & 63) & 1) != 0; };
    const auto texel = [&](int j) { return WarpTexel{in[j].color, table[in[j].code]}; };
    const WarpTexel before = i > 0 ? texel(i - 1) : WarpTexel{}, after = texel(i + 1);
    draw_silhouette(
        k, i, i > 0 && beside(i - 1) ? &before : nullptr, texel(i),
        beside(i + 1) ? &after : nullptr, out_width,
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
  auto* drawn = reinterpret_cast<WarpTexel*>(scratch);  // and a row for what covers nothing
  for (int at = 0; at < out_height * kWarpStrip; at += lanes)
    hn::StoreInterleaved2(hn::Zero(u), hn::Set(u, kEmptyWarped), u,
                          reinterpret_cast<std::uint32_t*>(drawn + at));
  // A bit for each column, by row: does it show something, and is it opaque?
  auto* shows = reinterpret_cast<std::uint64_t*>(drawn + (out_height + 1) * kWarpStrip) + 1;
  auto* solid = shows + height + 2;
  std::fill(shows - 1, shows - 1 + 2 * (height + 2), 0);
  const WarpTexel* from = in + x;
  const VI missed = hn::Set(n, out_height * kWarpStrip);
  FirstTexels texels;
  const auto draw_row = [&](int v) {
    const WarpTexel* row = from + std::ptrdiff_t(v) * pitch;
    for (int c = 0; c < columns; c += lanes) {
      VU color_a, code_a, color_b, code_b;
      hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(row + c), color_a, code_a);
      const auto inside = hn::FirstN(u, std::size_t(columns - c));
      const auto there = hn::AndNot(is_empty(code_of(code_a)), inside);
      if (hn::AllFalse(u, there)) continue;
      const auto opaque = hn::And(there, is_opaque(color_a));
      shows[v] |= bits_of(there) << c;
      solid[v] |= bits_of(opaque) << c;
      // The row after the last shows nothing.
      hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(row + pitch + c), color_b,
                           code_b);
      const auto valid = hn::And(hn::AndNot(is_empty(code_of(code_b)), opaque), is_opaque(color_b));
      if (hn::AllFalse(u, valid)) continue;
      const Pieces pieces = pieces_of(k, hn::Set(f, float(v)), color_a, code_a, color_b, code_b);
      find_texels(k, pieces, hn::RebindMask(n, valid), out_height, kWarpStrip, hn::Iota(n, c),
                  missed, texels);
      copy_texels(texels, 0, lanes, true, drawn, [&](int l) {
        draw_long(k, v, row[c + l], row[pitch + c + l], texels.first[l] / kWarpStrip + 2,
                  texels.count[l] - 2, drawn + c + l, kWarpStrip);
      });
    }
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
  for (int y = 0; y < out_height; ++y)
    for (int c = 0; c < columns; c += lanes) {
      const std::size_t at_texel = std::size_t(y) * to.pitch + std::size_t(x + c);
      VU color, code;
      hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(drawn + y * kWarpStrip + c),
                           color, code);
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
        hn::StoreU(color, u, colors);
        hn::StoreU(delta, U16(), deltas);
        hn::StoreU(flags, U16(), bits);
        std::copy_n(colors, columns - c, to.color + at_texel);
        std::copy_n(deltas, columns - c, to.delta + at_texel);
        std::copy_n(bits, columns - c, to.flags + at_texel);
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

std::size_t row_pass_scratch(int width) {
  return std::size_t(warp_pitch(width)) * 2 * sizeof(std::uint32_t) +
         std::size_t((width + 63) / 64 + 2) * 2 * sizeof(std::uint64_t);
}

std::size_t column_pass_scratch(int height, int out_height) {
  return std::size_t(kWarpStrip) * std::size_t(out_height + 1) * sizeof(WarpTexel) +
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

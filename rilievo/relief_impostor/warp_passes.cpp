// How it is done fast: a vector of samples beside each other and of those after them are the ends
// of as many pieces. Most pieces cover one texel or two, which are interpolated for all of them at
// once. In a row, texels of pieces beside each other lie beside each other, as long as no piece is
// turned over: their vectors are compressed and stored as they are. In the second pass, kWarpStrip
// columns are done at once, and pieces beside each other mostly begin in the same row or two: they
// are stored by masks. Longer pieces are interpolated one by one, a vector of texels at once.
// Silhouettes are few: their pieces are found by bits and drawn one by one.
#include "rilievo/relief_impostor/warp_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

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
// Of a number that fits. ConvertTo() would see to those that do not, too.
HWY_INLINE VI truncated(VF value) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return VI{_mm512_cvttps_epi32(value.raw)};
#elif HWY_TARGET == HWY_AVX2
  return VI{_mm256_cvttps_epi32(value.raw)};
#else
  return hn::ConvertTo(I(), value);
#endif
}
HWY_INLINE VF as_float(VU value) { return hn::ConvertTo(F(), hn::BitCast(I(), value)); }
HWY_INLINE auto is_empty(VU code) { return hn::Eq(code, hn::Set(U(), kEmptyWarped)); }

// An entry of the table.
HWY_INLINE VU code_of_level(const LevelCodes& k, VI level) {
  const F f;
  const VF at = hn::ConvertTo(f, level), most = hn::Set(f, float(kEmptyWarped - 1));
  const VF nearness = hn::Div(hn::Add(hn::Set(f, k.r0), hn::Mul(hn::Set(f, k.r1), at)),
                              hn::Add(hn::Set(f, k.c0), hn::Mul(hn::Set(f, k.c1), at)));
  const VF code = hn::Add(hn::Set(f, k.m0), hn::Mul(hn::Set(f, k.m1), nearness));
  const VF rounded = hn::Min(hn::Max(hn::Add(code, hn::Set(f, 0.5f)), hn::Zero(f)), most);
  const auto empty = hn::Eq(level, hn::Set(I(), std::int32_t(kEmptyLevel)));
  return hn::BitCast(
      U(), hn::IfThenElse(empty, hn::Set(I(), std::int32_t(kEmptyWarped)), truncated(rounded)));
}

// Two bytes of colours at a time: a + (b - a) t / 256, rounded.
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE VU mix_pairs(VU a, VU b, VU t) {
  const U u;
  const VU sum = hn::Add(hn::Mul(a, hn::Sub(hn::Set(u, 256), t)), hn::Mul(b, t));
  return hn::And(hn::ShiftRight<8>(hn::Add(sum, hn::Set(u, 0x00800080))), hn::Set(u, 0x00ff00ff));
}
HWY_INLINE VU mix_bytes(VU a, VU b, VU t) {
  const VU low = hn::Set(U(), 0x00ff00ff);
  const VU even = mix_pairs(hn::And(a, low), hn::And(b, low), t);
  const VU odd =
      mix_pairs(hn::And(hn::ShiftRight<8>(a), low), hn::And(hn::ShiftRight<8>(b), low), t);
  return hn::Or(even, hn::ShiftLeft<8>(odd));
}
#else
HWY_INLINE VU mix_bytes(VU a, VU b, VU t) {
  const U u;
  const hn::Repartition<std::uint16_t, U> d;
  const auto low = hn::Set(d, 0xff), half = hn::Set(d, 128);
  const auto from = hn::BitCast(d, a), to = hn::BitCast(d, b);
  const auto weight = hn::BitCast(d, hn::Or(t, hn::ShiftLeft<16>(t)));
  // 256 a + (b - a) t fits into 16 bits; what is between does by its remainder.
  const auto even_step = hn::Mul(hn::Sub(hn::And(to, low), hn::And(from, low)), weight);
  const auto even = hn::Add(hn::Add(hn::ShiftLeft<8>(from), half), even_step);
  const auto odd_step = hn::Mul(hn::Sub(hn::ShiftRight<8>(to), hn::ShiftRight<8>(from)), weight);
  const auto odd = hn::Add(hn::Add(hn::AndNot(low, from), half), odd_step);
  return hn::BitCast(u, hn::Or(hn::ShiftRight<8>(even), hn::AndNot(low, odd)));
}
#endif

// Ends of pieces: colours, codes as numbers, and where they land.
struct Ends {
  VU color;
  VF q, p;
};

// Colour and code, with kInterpolatedBit and kTornBit, of the texels with these centres, one of
// each piece from `a` to `b`, which must cover them.
HWY_INLINE void between(const Ends& a, const Ends& b, VF reach, VF center, VU& color, VU& code) {
  const F f;
  const U u;
  const VF from_a = hn::Sub(center, a.p), to_b = hn::Sub(b.p, center), length = hn::Sub(b.p, a.p);
  const VF t = hn::Min(hn::Max(hn::Div(from_a, length), hn::Zero(f)), hn::Set(f, 1.0f));
  const VF half = hn::Set(f, 0.5f);
  const VI t8 = truncated(hn::Add(hn::Mul(t, hn::Set(f, 256.0f)), half));
  color = mix_bytes(a.color, b.color, hn::BitCast(u, t8));
  const VF q = hn::Add(a.q, hn::Mul(t, hn::Sub(b.q, a.q)));
  const VU mixed = hn::BitCast(u, truncated(hn::Add(q, half)));
  const auto bit = [&](auto where, std::uint32_t value) {
    return hn::IfThenElseZero(hn::RebindMask(u, where), hn::Set(u, value));
  };
  const VU far = bit(hn::Gt(hn::Min(from_a, to_b), reach), kInterpolatedBit);
  const VU torn = bit(hn::Gt(length, hn::Set(f, kTear)), kTornBit);
  code = hn::Or(mixed, hn::Or(far, torn));
}
// The same, where codes of the ends may have these bits already.
HWY_INLINE void between(const Ends& a, const Ends& b, VU bits_a, VU bits_b, VF reach, VF center,
                        VU& color, VU& code) {
  const F f;
  const U u;
  between(a, b, reach, center, color, code);
  const VF t = hn::Div(hn::Sub(center, a.p), hn::Sub(b.p, a.p));
  const auto nearer_a = hn::RebindMask(u, hn::Lt(t, hn::Set(f, 0.5f)));
  const VU before =
      hn::And(hn::IfThenElse(nearer_a, bits_a, bits_b), hn::Set(u, kInterpolatedBit | kTornBit));
  code = hn::Or(code, before);
}

// The texel whose centre is the first after this position, of [0, limit].
HWY_INLINE VI cell_of(VF p, int limit) {
  const F f;
  const VF at = hn::Add(p, hn::Set(f, 0.5f));
  return truncated(hn::Min(hn::Max(at, hn::Zero(f)), hn::Set(f, float(limit))));
}

HWY_INLINE VF center_of(VI cell) { return hn::Add(hn::ConvertTo(F(), cell), hn::Set(F(), 0.5f)); }

// Is a texel opaque?
HWY_INLINE auto is_opaque(VU color) { return hn::Eq(hn::ShiftRight<24>(color), hn::Set(U(), 255)); }

// The bits of a mask.
template <class Mask>
HWY_INLINE std::uint64_t bits_of(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(U(), hn::RebindMask(U(), mask), bytes);
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

// Calls `put(color, code, x, count)` with vectors of texels of one piece, of [x, x + count).
template <class Put>
HWY_INLINE void draw_long(const Ends& a, const Ends& b, VU bits_a, VU bits_b, VF reach, int x,
                          int count, Put&& put) {
  const int lanes = int(hn::Lanes(F()));
  for (int end = x + count; x < end; x += lanes) {
    VU color, code;
    between(a, b, bits_a, bits_b, reach, center_of(hn::Iota(I(), x)), color, code);
    put(color, code, x, std::min(lanes, end - x));
  }
}

// The first two texels of the pieces of a row that begin at samples beside each other.
class RowTexels {
 public:
  // Of the `valid` ones, with `count` texels from `first` on; negative where a piece is turned
  // over. False if they cover nothing.
  HWY_INLINE bool find(const Ends& a, const Ends& b, hn::Mask<I> valid, VI first, VI count,
                       VF reach) {
    const I n;
    const U u;
    shown_ = bits_of(hn::And(valid, hn::Gt(count, hn::Zero(n))));
    if (!shown_) return false;
    breaks_ = ~bits_of(hn::AndNot(hn::Lt(count, hn::Zero(n)), valid));
    two_ = shown_ & bits_of(hn::Gt(count, hn::Set(n, 1)));
    long_ = 0;
    hn::Store(first, n, first_);
    const VF center = center_of(first);
    between(a, b, reach, center, color_, code_);
    if (!two_) return true;
    long_ = shown_ & bits_of(hn::Gt(count, hn::Set(n, 2)));
    if (long_) hn::Store(count, n, count_);
    VU color, code;
    between(a, b, reach, hn::Add(center, hn::Set(F(), 1.0f)), color, code);
    hn::StoreInterleaved2(color_, color, u, colors_);
    hn::StoreInterleaved2(code_, code, u, codes_);
    return true;
  }

  // Draws them in order; `draw_rest(lane, x, count)` draws those of a long piece but its first two.
  template <class Rest>
  HWY_INLINE void draw(bool up, std::uint32_t* colors, std::uint32_t* codes,
                       Rest&& draw_rest) const {
    // Neighbours are drawn together, as their texels lie beside each other, but not across a piece
    // that is turned over or covers more than two texels.
    for (std::uint64_t rest = shown_; rest;) {
      int last = 0;
      std::uint64_t run = rest;
      if (up) {
        const std::uint64_t from = ~std::uint64_t(0) << std::countr_zero(rest);
        const std::uint64_t stops = (breaks_ | long_ << 1) & from << 1;
        if (stops) run &= (stops & -stops) - 1;
        last = 63 - std::countl_zero(run);
      } else {
        last = 63 - std::countl_zero(rest);
        const std::uint64_t stops = (breaks_ | long_) & ((std::uint64_t(1) << last) - 1);
        if (stops) run &= ~std::uint64_t(0) << (64 - std::countl_zero(stops));
      }
      rest &= ~run;
      draw_run(run, colors, codes);
      if (long_ >> last & 1) draw_rest(last, first_[last] + 2, count_[last] - 2);
    }
  }

 private:
  HWY_INLINE void draw_run(std::uint64_t run, std::uint32_t* colors, std::uint32_t* codes) const {
    const U u;
    int x = first_[std::countr_zero(run)];
    const auto put = [&](VU color, VU code, std::uint64_t bits) {
      const auto mask = hn::LoadMaskBits(u, reinterpret_cast<const std::uint8_t*>(&bits));
      const int count = std::popcount(bits);
      const auto some = hn::FirstN(u, std::size_t(count));
      hn::BlendedStore(hn::Compress(color, mask), some, u, colors + x);
      hn::BlendedStore(hn::Compress(code, mask), some, u, codes + x);
      x += count;
    };
    if (!two_) {
      put(color_, code_, run);
      return;
    }
    const int lanes = int(hn::Lanes(u));
    const auto part = (std::uint64_t(1) << lanes) - 1;
    const std::uint64_t both = spread(run) | spread(run & two_) << 1;
    if (both & part) put(hn::Load(u, colors_), hn::Load(u, codes_), both & part);
    if (both >> lanes)
      put(hn::Load(u, colors_ + lanes), hn::Load(u, codes_ + lanes), both >> lanes);
  }
  // Bit i of 16 to bit 2 i.
  static HWY_INLINE std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 8) & 0x00ff00ff;
    bits = (bits | bits << 4) & 0x0f0f0f0f;
    bits = (bits | bits << 2) & 0x33333333;
    return (bits | bits << 1) & 0x55555555;
  }

  // By lane, a bit: does the piece cover anything; is it turned over or not there; does it cover
  // two texels or more; more than two?
  std::uint64_t shown_ = 0, breaks_ = 0, two_ = 0, long_ = 0;
  VU color_, code_;                                 // the first texels
  HWY_ALIGN std::uint32_t colors_[32], codes_[32];  // if any covers two: the first and the second
  HWY_ALIGN std::int32_t first_[16], count_[16];
};

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

void do_row(const AxisWarp& axis, const LevelCodes& level_codes, const std::uint32_t* table,
            const WarpTexel* in, int width, std::uint32_t* out, std::size_t block, int out_width,
            std::byte* scratch) {
  const F f;
  const I n;
  const U u;
  const AxisWarp k = axis;
  const LevelCodes of_levels = level_codes;
  const int lanes = int(hn::Lanes(f)), pitch = warp_pitch(width), out_pitch = warp_pitch(out_width);
  // The result in one piece. Samples: colours, codes as numbers (of what is not opaque: empty),
  // where they land, and in which texels.
  auto* out_colors = reinterpret_cast<std::uint32_t*>(scratch);
  std::uint32_t *out_codes = out_colors + out_pitch, *colors = out_codes + out_pitch;
  auto* codes = reinterpret_cast<float*>(colors + pitch);
  float* places = codes + pitch;
  auto* cells = reinterpret_cast<std::int32_t*>(places + pitch);
  // By sample, a bit: does it show something, and is it opaque? A word beyond each end.
  const int words = (width + 63) / 64 + 2;
  auto* shows = reinterpret_cast<std::uint64_t*>(cells + pitch) + 1;
  auto* solid = shows + words;
  std::fill(shows - 1, shows - 1 + 2 * words, 0);
  const VF empty = hn::Set(f, float(kEmptyWarped));
  const VF a0 = hn::Set(f, k.a0), a1 = hn::Set(f, k.a1), b0 = hn::Set(f, k.b0),
           b1 = hn::Set(f, k.b1);
  int done = 0;
  for (; done < width; done += lanes) {
    VU color, level;
    hn::LoadInterleaved2(u, reinterpret_cast<const std::uint32_t*>(in + done), color, level);
    // Faster than to gather entries of the table.
    const VU code = code_of_level(of_levels, hn::BitCast(n, level));
    const auto opaque = is_opaque(color);
    const auto there = hn::Not(is_empty(code));
    shows[done / 64] |= bits_of(there) << (done % 64);
    solid[done / 64] |= bits_of(hn::And(there, opaque)) << (done % 64);
    const VF i = hn::ConvertTo(f, hn::Iota(n, done)), q = as_float(code);
    const VF p = hn::Add(hn::Add(a0, hn::Mul(a1, i)), hn::Mul(q, hn::Add(b0, hn::Mul(b1, i))));
    hn::StoreU(color, u, colors + done);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(f, opaque), q, empty), f, codes + done);
    hn::StoreU(p, f, places + done);
    hn::StoreU(cell_of(p, out_width), n, cells + done);
  }
  colors[done] = 0, codes[done] = float(kEmptyWarped), places[done] = 0, cells[done] = 0;
  const auto block_of = [&](int x) { return out + std::size_t(x / 16) * block + x % 16; };
  std::uint64_t any = 0;
  for (int word = 0; word < words - 2; ++word) any |= shows[word];
  for (int x = 0; x < out_width; x += lanes) {
    std::uint32_t* codes_to = any ? out_codes + x : block_of(x) + 16;
    if (any) hn::StoreU(hn::Zero(u), u, out_colors + x);
    hn::StoreU(hn::Set(u, kEmptyWarped), u, codes_to);
  }
  if (!any) return;
  const VF reach = hn::Set(f, k.reach);
  RowTexels texels;
  for (const AxisWarp::Range range : k.ranges) {
    if (range.from >= range.to) continue;
    const int low = range.from / lanes * lanes, high = (range.to - 1) / lanes * lanes;
    for (int at = low; at <= high; at += lanes) {
      const int i = range.up ? at : low + high - at;
      const auto ends_at = [&](int from) -> Ends {
        return {hn::LoadU(u, colors + from), hn::LoadU(f, codes + from),
                hn::LoadU(f, places + from)};
      };
      const Ends a = ends_at(i), b = ends_at(i + 1);
      const auto missing = hn::Or(hn::Eq(a.q, empty), hn::Eq(b.q, empty));
      auto valid = hn::Not(hn::RebindMask(n, missing));
      if (i < range.from || i + lanes > range.to) {
        const VI index = hn::Iota(n, i);
        valid = hn::And(valid, hn::And(hn::Gt(index, hn::Set(n, range.from - 1)),
                                       hn::Lt(index, hn::Set(n, range.to))));
      }
      const VI first = hn::LoadU(n, cells + i), count = hn::Sub(hn::LoadU(n, cells + i + 1), first);
      if (!texels.find(a, b, valid, first, count, reach)) continue;
      texels.draw(range.up, out_colors, out_codes, [&](int lane, int x, int more) {
        const auto one = [&](int j) -> Ends {
          return {hn::Set(u, colors[j]), hn::Set(f, codes[j]), hn::Set(f, places[j])};
        };
        draw_long(one(i + lane), one(i + lane + 1), hn::Zero(u), hn::Zero(u), reach, x, more,
                  [&](VU color, VU code, int to, int some) {
                    const auto mask = hn::FirstN(u, std::size_t(some));
                    hn::BlendedStore(color, mask, u, out_colors + to);
                    hn::BlendedStore(code, mask, u, out_codes + to);
                  });
      });
    }
  }
  const auto draw_edge = [&](int i) {
    const auto beside = [&](int j) { return (shows[j >> 6] >> (j & 63) & 1) != 0; };
    const auto texel = [&](int j) { return WarpTexel{in[j].color, table[in[j].code]}; };
    const WarpTexel before = i > 0 ? texel(i - 1) : WarpTexel{}, after = texel(i + 1);
    draw_silhouette(k, i, i > 0 && beside(i - 1) ? &before : nullptr, texel(i),
                    beside(i + 1) ? &after : nullptr, out_width,
                    [&](int x, std::uint32_t color, std::uint32_t code) {
                      WarpTexel to{out_colors[x], out_codes[x]};
                      blend(to, color, code);
                      out_colors[x] = to.color, out_codes[x] = to.code;
                    });
  };
  const auto edges = [&](int word) {
    const std::uint64_t here = solid[word], left = here << 1 | solid[word - 1] >> 63,
                        right = here >> 1 | solid[word + 1] << 63;
    return shows[word] & ~(here & left & right);
  };
  for_bits(k, edges, draw_edge);
  for (int x = 0; x < out_width; x += lanes) {
    hn::StoreU(hn::LoadU(u, out_colors + x), u, block_of(x));
    hn::StoreU(hn::LoadU(u, out_codes + x), u, block_of(x) + 16);
  }
}

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

void do_table(const LevelCodes& k, std::uint32_t* table) {
  const I n;
  const U u;
  for (std::uint32_t level = 0; level <= kEmptyLevel; level += std::uint32_t(hn::Lanes(n)))
    hn::StoreU(code_of_level(k, hn::Iota(n, std::int32_t(level))), u, table + level);
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
  const std::size_t words =
      std::size_t(warp_pitch(width)) * 4 + std::size_t(warp_pitch(out_width)) * 2;
  return words * sizeof(std::uint32_t) +
         std::size_t((width + 63) / 64 + 2) * 2 * sizeof(std::uint64_t);
}

std::size_t column_pass_scratch(int height, int out_height) {
  return std::size_t(kWarpStrip) * std::size_t(out_height) * sizeof(WarpTexel) +
         std::size_t(kWarpStrip / 16 * 2 * (height + 2)) * sizeof(std::uint16_t);
}

void row_pass(const AxisWarp& axis, const LevelCodes& codes, const std::uint32_t* table,
              const WarpTexel* in, int width, std::uint32_t* out, std::size_t block, int out_width,
              std::byte* scratch) {
  HWY_DYNAMIC_DISPATCH(do_row)(axis, codes, table, in, width, out, block, out_width, scratch);
}

WarpedTexels column_pass(const AxisWarp& axis, const std::uint32_t* in, std::size_t block,
                         int height, int x, int columns, const WarpPlanes& to, int out_height,
                         std::byte* scratch) {
  return HWY_DYNAMIC_DISPATCH(do_columns)(axis, in, block, height, x, columns, to, out_height,
                                          scratch);
}

void level_table(const LevelCodes& codes, std::uint32_t* table) {
  HWY_DYNAMIC_DISPATCH(do_table)(codes, table);
}

}  // namespace rilievo
#endif

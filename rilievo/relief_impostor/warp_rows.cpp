// The first pass, fast: a vector of samples beside each other and of those after them are the ends
// of as many pieces. Most pieces cover one texel or two, which are interpolated for all of them at
// once; texels of pieces beside each other lie beside each other, as long as no piece is turned
// over: their vectors are compressed and stored as they are. Longer pieces are interpolated one by
// one, a vector of texels at once. Silhouettes are few: their pieces are found by bits and drawn
// one by one.
#include "rilievo/relief_impostor/warp_passes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/relief_impostor/warp_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/core/lane_numbers.inl"
#include "rilievo/relief_impostor/warp_texels.inl"

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
    const VF i = hn::ConvertTo(f, lane_numbers(n, done)), q = as_float(code);
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
        const VI index = lane_numbers(n, i);
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

void do_table(const LevelCodes& k, std::uint32_t* table) {
  const I n;
  const U u;
  for (std::uint32_t level = 0; level <= kEmptyLevel; level += std::uint32_t(hn::Lanes(n)))
    hn::StoreU(code_of_level(k, lane_numbers(n, std::int32_t(level))), u, table + level);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(do_row);
HWY_EXPORT(do_table);

std::size_t row_pass_scratch(int width, int out_width) {
  const std::size_t words =
      std::size_t(warp_pitch(width)) * 4 + std::size_t(warp_pitch(out_width)) * 2;
  return words * sizeof(std::uint32_t) +
         std::size_t((width + 63) / 64 + 2) * 2 * sizeof(std::uint64_t);
}

void row_pass(const AxisWarp& axis, const LevelCodes& codes, const std::uint32_t* table,
              const WarpTexel* in, int width, std::uint32_t* out, std::size_t block, int out_width,
              std::byte* scratch) {
  HWY_DYNAMIC_DISPATCH(do_row)(axis, codes, table, in, width, out, block, out_width, scratch);
}

void level_table(const LevelCodes& codes, std::uint32_t* table) {
  HWY_DYNAMIC_DISPATCH(do_table)(codes, table);
}

}  // namespace rilievo
#endif

// The four texels around a place are copied one by one; all else is done for a vector of texels.
// The texel with the largest share of the place, of those that show something, says which surface
// is there; those of other surfaces do not count, and what is empty is transparent.
#include "rilievo/relief_impostor/merge_rows.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/relief_impostor/merge_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/core/lane_numbers.inl"

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using U16 = hn::Rebind<std::uint16_t, I>;
using VF = hn::Vec<F>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<F>;

// Depths that differ by a smaller share belong to the same surface: pictures have 12 bits of depth,
// and where surfaces are seen at a grazing angle, a texel's error is several times its size.
constexpr float kSame = 0.01f;

HWY_INLINE VF number(float value) { return hn::Set(F(), value); }
HWY_INLINE VU word(std::uint32_t value) { return hn::Set(U(), value); }
HWY_INLINE VF to_float(VU value) { return hn::ConvertTo(F(), hn::BitCast(I(), value)); }
HWY_INLINE Mask of_floats(hn::Mask<U> mask) { return hn::RebindMask(F(), mask); }
HWY_INLINE hn::Mask<U> of_words(Mask mask) { return hn::RebindMask(U(), mask); }

// Premultiplied colours, 0 to 255.
struct Channels {
  VF r, g, b, a;
};
HWY_INLINE Channels channels(VU color) {
  const VU byte = word(255);
  return {to_float(hn::And(color, byte)), to_float(hn::And(hn::ShiftRight<8>(color), byte)),
          to_float(hn::And(hn::ShiftRight<16>(color), byte)), to_float(hn::ShiftRight<24>(color))};
}
template <class Do>
HWY_INLINE Channels each(const Channels& a, const Channels& b, Do&& value) {
  return {value(a.r, b.r), value(a.g, b.g), value(a.b, b.b), value(a.a, b.a)};
}
HWY_INLINE VU rounded(const Channels& color) {
  const auto byte = [](VF value) {
    const VF most = hn::Min(hn::Add(value, number(0.5f)), number(255));
    return hn::BitCast(U(), hn::ConvertTo(I(), most));
  };
  return hn::Or(hn::Or(byte(color.r), hn::ShiftLeft<8>(byte(color.g))),
                hn::Or(hn::ShiftLeft<16>(byte(color.b)), hn::ShiftLeft<24>(byte(color.a))));
}
// `front` before `behind`.
HWY_INLINE VU one_over(VU front, VU behind) {
  const Channels first = channels(front);
  const VF through = hn::Sub(number(1), hn::Div(first.a, number(255)));
  return rounded(
      each(first, channels(behind), [&](VF a, VF b) { return hn::Add(a, hn::Mul(through, b)); }));
}

HWY_INLINE VF inverse_of(const InverseDepth& depth, VU code) {
  return hn::Add(number(depth.first), hn::Mul(number(depth.per_code), to_float(code)));
}
HWY_INLINE VU code_at(const InverseDepth& depth, VF inverse) {
  const VF code =
      hn::Add(hn::Div(hn::Sub(inverse, number(depth.first)), number(depth.per_code)), number(0.5f));
  const VF most = number(float(kEmptyWarped - 1));
  return hn::BitCast(U(), hn::ConvertTo(I(), hn::Min(hn::Max(code, number(0)), most)));
}

// What the other warp shows at places.
struct Taps {
  Channels color;
  VF inverse;
  Mask known;  // seen, and not torn
};

// Between four texels each.
HWY_INLINE Taps taps_at(const MergeInput& in, VF u, VF v, Mask ahead) {
  const U words;
  const I n;
  const VF x = hn::Sub(u, number(0.5f)), y = hn::Sub(v, number(0.5f));
  const auto within = [](VF at, int size) {
    return hn::And(hn::Gt(at, number(-1)), hn::Lt(at, number(float(size))));
  };
  const Mask inside =
      hn::And(ahead, hn::And(within(x, in.other_width), within(y, in.other_height)));
  Taps taps;
  taps.known = inside;
  taps.inverse = number(0);
  taps.color = {number(0), number(0), number(0), number(0)};
  if (hn::AllFalse(F(), inside)) return taps;
  const VF left = hn::Floor(x), top = hn::Floor(y);
  const VF fx = hn::Sub(x, left), fy = hn::Sub(y, top);

  // From the texel beyond the corner.
  const auto index = [&](VF at) {
    return hn::ConvertTo(n, hn::IfThenElseZero(inside, hn::Add(at, number(1))));
  };
  HWY_ALIGN std::int32_t at[16];
  hn::Store(hn::Add(hn::Mul(index(top), hn::Set(n, in.other_pitch)), index(left)), n, at);
  HWY_ALIGN std::uint32_t above[64], below[64];
  for (std::size_t k = 0; k < hn::Lanes(n); ++k) {
    const WarpTexel* texel = in.other + at[k];
    std::memcpy(above + 4 * k, texel, 16);
    std::memcpy(below + 4 * k, texel + in.other_pitch, 16);
  }
  VU colors[4], codes[4];
  hn::LoadInterleaved4(words, above, colors[0], codes[0], colors[1], codes[1]);
  hn::LoadInterleaved4(words, below, colors[2], codes[2], colors[3], codes[3]);

  const VF right = hn::Sub(number(1), fx), lower = hn::Sub(number(1), fy);
  const VF weights[4] = {hn::Mul(right, lower), hn::Mul(fx, lower), hn::Mul(right, fy),
                         hn::Mul(fx, fy)};
  Mask there[4];
  VF most = number(-1);
  VU best = word(kEmptyWarped);
  for (int k = 0; k < 4; ++k) {
    const VU code = hn::And(codes[k], word(0xffff));
    there[k] = of_floats(hn::Ne(code, word(kEmptyWarped)));
    const Mask better = hn::And(there[k], hn::Gt(weights[k], most));
    most = hn::IfThenElse(better, weights[k], most);
    best = hn::IfThenElse(of_words(better), codes[k], best);
    codes[k] = code;
  }
  const VU torn = word(kTornBit);
  const auto unknown = hn::Or(hn::Eq(hn::And(best, torn), torn), hn::Eq(best, word(kEmptyWarped)));
  taps.known = hn::AndNot(of_floats(unknown), inside);
  taps.inverse = inverse_of(in.other_depth, hn::And(best, word(0xffff)));
  const VF near = hn::Mul(number(kSame), taps.inverse);
  VF sum = number(0);
  for (int k = 0; k < 4; ++k) {
    const VF off = hn::Abs(hn::Sub(inverse_of(in.other_depth, codes[k]), taps.inverse));
    const Mask same = hn::Le(off, near);
    sum = hn::Add(sum, hn::IfThenZeroElse(hn::AndNot(same, there[k]), weights[k]));
    const VF weight = hn::IfThenElseZero(hn::And(there[k], same), weights[k]);
    taps.color = each(taps.color, channels(colors[k]),
                      [&](VF to, VF from) { return hn::Add(to, hn::Mul(weight, from)); });
  }
  const VF scale = hn::Div(number(1), sum);
  taps.color = each(taps.color, taps.color, [&](VF value, VF) { return hn::Mul(value, scale); });
  return taps;
}

// A vector of texels from column x; `row` is y map[1] + map[2]. All lanes are read and written.
HWY_INLINE void merge_lanes(const MergeInput& in, const float (&row)[3], int x,
                            std::uint32_t* color, std::uint16_t* delta, std::uint16_t* flags) {
  const F f;
  const I n;
  const U words;
  const U16 shorts;
  const VF center = hn::Add(hn::ConvertTo(f, lane_numbers(n, x)), number(0.5f));
  const auto mapped = [&](int k) {
    return hn::Add(hn::Mul(number(in.map[0][k]), center), number(row[k]));
  };
  const VF w = mapped(2);
  const Mask ahead = hn::Gt(w, number(0));
  const VF per_w = hn::Div(number(1), w);
  const Taps taps = taps_at(in, hn::Mul(mapped(0), per_w), hn::Mul(mapped(1), per_w), ahead);
  const Mask shows = hn::And(taps.known, hn::Ge(taps.color.a, number(float(kFaintAlpha))));
  if (hn::AllFalse(f, shows)) return;

  const VU own_color = hn::LoadU(words, color);
  const VU own_code = hn::PromoteTo(words, hn::LoadU(shorts, delta));
  const VU own_flags = hn::PromoteTo(words, hn::LoadU(shorts, flags));
  const Channels own = channels(own_color);
  const VF inverse = hn::Mul(w, taps.inverse);
  const VF own_inverse = inverse_of(in.main_depth, own_code);

  // Nothing that is known is here.
  const VU torn = word(kTornBit >> 16);
  const Mask blank = of_floats(
      hn::Or(hn::Eq(own_code, word(kEmptyWarped)), hn::Eq(hn::And(own_flags, torn), torn)));
  const Mask both = hn::AndNot(blank, shows);
  // The same surface. Where one picture has its silhouette, the other may know more.
  const Mask same = hn::And(
      both, hn::Le(hn::Abs(hn::Sub(inverse, own_inverse)), hn::Mul(number(kSame), own_inverse)));
  const Mask more = hn::And(same, hn::Gt(taps.color.a, hn::Add(own.a, number(0.5f))));
  const Mask take = hn::Or(hn::And(blank, shows), more);
  const Mask mix = hn::And(hn::AndNot(more, same), hn::Ge(taps.color.a, number(254.5f)));
  const Mask apart = hn::AndNot(same, both);
  const Mask before = hn::And(apart, hn::Gt(inverse, own_inverse));
  const Mask behind = hn::And(hn::AndNot(before, apart), hn::Lt(own.a, number(255)));

  const VU shown = rounded(taps.color);
  VU result = hn::IfThenElse(of_words(take), shown, own_color);
  if (in.share > 0) {
    const VF share = number(in.share);
    const Channels mixed = each(
        own, taps.color, [&](VF a, VF b) { return hn::Add(a, hn::Mul(share, hn::Sub(b, a))); });
    result = hn::IfThenElse(of_words(mix), rounded(mixed), result);
  }
  const Mask stacked = hn::Or(before, behind);
  if (!hn::AllFalse(f, stacked)) {
    const VU front = hn::IfThenElse(of_words(before), shown, own_color);
    const VU back = hn::IfThenElse(of_words(before), own_color, shown);
    result = hn::IfThenElse(of_words(stacked), one_over(front, back), result);
  }
  hn::StoreU(result, words, color);

  const VF half = number(128);
  const Mask moves = hn::Or(take, hn::Or(hn::And(before, hn::Ge(taps.color.a, half)),
                                         hn::And(behind, hn::Lt(own.a, half))));
  if (hn::AllFalse(f, moves)) return;
  const VU code = hn::IfThenElse(of_words(moves), code_at(in.main_depth, inverse), own_code);
  hn::StoreU(hn::DemoteTo(shorts, hn::BitCast(n, code)), shorts, delta);
  const VU kept = hn::IfThenZeroElse(of_words(take), own_flags);
  hn::StoreU(hn::DemoteTo(shorts, hn::BitCast(n, kept)), shorts, flags);
}

void do_merge_row(const MergeInput& in, int y, int width, std::uint32_t* color,
                  std::uint16_t* delta, std::uint16_t* flags) {
  const int lanes = int(hn::Lanes(F()));
  float row[3];
  for (int k = 0; k < 3; ++k) row[k] = in.map[1][k] * (float(y) + 0.5f) + in.map[2][k];
  int x = 0;
  for (; x + lanes <= width; x += lanes) merge_lanes(in, row, x, color + x, delta + x, flags + x);
  if (x >= width) return;
  // The rest by way of memory of our own: beyond it lies what others write.
  HWY_ALIGN std::uint32_t colors[16] = {};
  HWY_ALIGN std::uint16_t deltas[16] = {}, bits[16] = {};
  const int rest = width - x;
  std::copy_n(color + x, rest, colors);
  std::copy_n(delta + x, rest, deltas);
  std::copy_n(flags + x, rest, bits);
  merge_lanes(in, row, x, colors, deltas, bits);
  std::copy_n(colors, rest, color + x);
  std::copy_n(deltas, rest, delta + x);
  std::copy_n(bits, rest, flags + x);
}

void do_pack_row(const std::uint32_t* color, const std::uint16_t* delta, const std::uint16_t* flags,
                 int width, WarpTexel* to) {
  const U words;
  const U16 shorts;
  const int lanes = int(hn::Lanes(words));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const VU code = hn::PromoteTo(words, hn::LoadU(shorts, delta + x));
    const VU bits = hn::PromoteTo(words, hn::LoadU(shorts, flags + x));
    hn::StoreInterleaved2(hn::LoadU(words, color + x), hn::Or(code, hn::ShiftLeft<16>(bits)), words,
                          reinterpret_cast<std::uint32_t*>(to + x));
  }
  for (; x < width; ++x)
    to[x] = {color[x], std::uint32_t(delta[x]) | std::uint32_t(flags[x]) << 16};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(do_merge_row);
HWY_EXPORT(do_pack_row);

void pack_row(const std::uint32_t* color, const std::uint16_t* delta, const std::uint16_t* flags,
              int width, WarpTexel* to) {
  HWY_DYNAMIC_DISPATCH(do_pack_row)(color, delta, flags, width, to);
}

void merge_row(const MergeInput& input, int y, int width, std::uint32_t* color,
               std::uint16_t* delta, std::uint16_t* flags) {
  HWY_DYNAMIC_DISPATCH(do_merge_row)(input, y, width, color, delta, flags);
}

}  // namespace rilievo
#endif

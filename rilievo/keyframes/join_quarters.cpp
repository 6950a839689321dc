#include "rilievo/keyframes/join_quarters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/color.h"
#include "rilievo/core/depth.h"
#include "rilievo/keyframes/keyframe.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/keyframes/join_quarters.cpp"
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
using VF = hn::Vec<F>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<F>;
constexpr int kMaxLanes = 16;

HWY_INLINE VU bits(std::uint32_t value) { return hn::Set(U(), value); }
HWY_INLINE VU count_of(Mask mask) { return hn::IfThenElseZero(hn::RebindMask(U(), mask), bits(1)); }

// Depths that differ by less are one surface's.
constexpr float kSameSurface = 0.03f;

HWY_INLINE Mask same_surface(VF inverse_z, VF as) {
  return hn::Le(hn::Abs(hn::Sub(inverse_z, as)), hn::Mul(hn::Set(F(), kSameSurface), as));
}

// A quarter: its colour and 1 / eye_z, one for each lane.
struct Quarters {
  VU color;
  VF inverse_z;
};

// The quarters at 2 i and 2 i + 1 from `at` on.
HWY_INLINE void load_two(const std::uint32_t* colors, const float* inverse_z, int at, Quarters& one,
                         Quarters& other) {
  hn::LoadInterleaved2(U(), colors + at, one.color, other.color);
  hn::LoadInterleaved2(F(), inverse_z + at, one.inverse_z, other.inverse_z);
}

// A quarter's colour, smoothed if asked for, and of quarter_code() how many sides show what.
template <bool smooth>
HWY_INLINE VU with_sides(const Quarters& own, const Quarters& left, const Quarters& right,
                         const Quarters& above, const Quarters& below) {
  VU same = bits(0), nearer = bits(0);
  // Two bytes at a time.
  VU even = hn::Mul(bits(kOwnParts), hn::And(own.color, bits(0x00ff00ff))),
     odd = hn::Mul(bits(kOwnParts), hn::And(hn::ShiftRight<8>(own.color), bits(0xff)));
  for (const Quarters* side : {&left, &right, &above, &below}) {
    const Mask alike = same_surface(side->inverse_z, own.inverse_z);
    same = hn::Add(same, count_of(alike));
    nearer = hn::Add(nearer, count_of(hn::AndNot(alike, hn::Gt(side->inverse_z, own.inverse_z))));
    if constexpr (smooth) {
      const VU color = hn::IfThenElseZero(hn::RebindMask(U(), alike), side->color);
      even = hn::Add(even, hn::And(color, bits(0x00ff00ff)));
      odd = hn::Add(odd, hn::And(hn::ShiftRight<8>(color), bits(0xff)));
    }
  }
  const VU code = hn::Or(hn::ShiftLeft<27>(same), hn::ShiftLeft<24>(nearer));
  if constexpr (!smooth) return hn::Or(own.color, code);
  const auto inverse = [](std::uint32_t parts) { return bits((65536 + parts / 2) / parts); };
  VU per = inverse(kOwnParts);
  for (std::uint32_t sides = 1; sides <= 4; ++sides)
    per = hn::IfThenElse(hn::Eq(same, bits(sides)), inverse(kOwnParts + sides), per);
  const auto mean = [&](VU sum) {
    return hn::ShiftRight<16>(hn::Add(hn::Mul(sum, per), bits(32768)));
  };
  const VU low = mean(hn::And(even, bits(0xffff))), middle = mean(odd),
           high = mean(hn::ShiftRight<16>(even));
  return hn::Or(hn::Or(low, hn::ShiftLeft<8>(middle)), hn::Or(hn::ShiftLeft<16>(high), code));
}

// The texels from `x` on, one for each lane.
template <bool smooth>
HWY_INLINE void join(const QuarterRows& rows, int x, const TexelRow& out) {
  Quarters above[2], below[2], upper[4], lower[4];
  load_two(rows.colors[0], rows.inverse_z[0], 2 * x, above[0], above[1]);
  for (const int at : {0, 2}) {
    load_two(rows.colors[1], rows.inverse_z[1], 2 * x + at - 1, upper[at], upper[at + 1]);
    load_two(rows.colors[2], rows.inverse_z[2], 2 * x + at - 1, lower[at], lower[at + 1]);
  }
  load_two(rows.colors[3], rows.inverse_z[3], 2 * x, below[0], below[1]);
  const VF w[4] = {upper[1].inverse_z, upper[2].inverse_z, lower[1].inverse_z, lower[2].inverse_z};
  VU colors[4] = {with_sides<smooth>(upper[1], upper[0], upper[2], above[0], lower[1]),
                  with_sides<smooth>(upper[2], upper[1], upper[3], above[1], lower[2]),
                  with_sides<smooth>(lower[1], lower[0], lower[2], upper[1], below[0]),
                  with_sides<smooth>(lower[2], lower[1], lower[3], upper[2], below[1])};
  const VF second = hn::Max(hn::Min(hn::Max(w[0], w[1]), hn::Max(w[2], w[3])),
                            hn::Max(hn::Min(w[0], w[1]), hn::Min(w[2], w[3])));
  VU object[4], chosen = bits(0), own_count = bits(0);
  if (rows.objects[0]) {
    hn::LoadInterleaved2(U(), rows.objects[0] + 2 * x, object[0], object[1]);
    hn::LoadInterleaved2(U(), rows.objects[1] + 2 * x, object[2], object[3]);
  }
  VF sum = hn::Zero(F());
  for (int i = 0; i < 4; ++i) {
    const Mask own = same_surface(w[i], second);
    if (rows.objects[0])
      chosen = hn::IfThenElse(hn::RebindMask(U(), hn::Eq(w[i], second)), object[i], chosen);
    sum = hn::Add(sum, hn::IfThenElseZero(own, w[i]));
    own_count = hn::Add(own_count, count_of(own));
    const VU elsewhere = hn::IfThenElse(hn::RebindMask(U(), hn::Gt(w[i], second)),
                                        bits(quarter_code(Quarter::nearer, 0, 0)),
                                        bits(quarter_code(Quarter::farther, 0, 0)));
    colors[i] = hn::Or(colors[i], hn::IfThenZeroElse(hn::RebindMask(U(), own), elsewhere));
  }
  hn::StoreInterleaved2(colors[0], colors[1], U(), out.colors[0] + 2 * x);
  hn::StoreInterleaved2(colors[2], colors[3], U(), out.colors[1] + 2 * x);
  hn::StoreU(hn::Div(sum, hn::ConvertTo(F(), hn::BitCast(I(), own_count))), F(), out.inverse_z + x);
  hn::StoreU(chosen, U(), out.objects + x);
}

void join_row(const QuarterRows& rows, int texels, bool smooth, const TexelRow& out) {
  const int lanes = int(hn::Lanes(F()));
  const auto join_at = [&](const QuarterRows& from, int x, const TexelRow& to) {
    smooth ? join<true>(from, x, to) : join<false>(from, x, to);
  };
  const int whole = texels / lanes * lanes, rest = texels - whole;
  for (int x = 0; x < whole; x += lanes) join_at(rows, x, out);
  if (rest == 0) return;
  // A copy of the rest, with room for all lanes.
  constexpr int kRoom = 2 * kMaxLanes + 2;
  std::uint32_t colors[4][kRoom] = {}, objects[2][kRoom] = {};
  float inverse_z[4][kRoom] = {};
  QuarterRows from = {};
  for (int row = 0; row < 4; ++row) {
    std::copy_n(rows.colors[row] + 2 * whole - 1, 2 * rest + 2, colors[row]);
    std::copy_n(rows.inverse_z[row] + 2 * whole - 1, 2 * rest + 2, inverse_z[row]);
    from.colors[row] = colors[row] + 1, from.inverse_z[row] = inverse_z[row] + 1;
  }
  std::uint32_t joined[2][2 * kMaxLanes], shown[kMaxLanes];
  float depths[kMaxLanes];
  if (rows.objects[0])
    for (int row = 0; row < 2; ++row) {
      std::copy_n(rows.objects[row] + 2 * whole, 2 * rest, objects[row]);
      from.objects[row] = objects[row];
    }
  join_at(from, 0, {{joined[0], joined[1]}, depths, shown});
  for (int row = 0; row < 2; ++row) std::copy_n(joined[row], 2 * rest, out.colors[row] + 2 * whole);
  std::copy_n(depths, rest, out.inverse_z + whole);
  std::copy_n(shown, rest, out.objects + whole);
}

// Scaled by the square root: the curve of sRGB is close to it.
constexpr int kBytes = 4096;

HWY_INLINE VU bytes_of(const std::uint32_t* table, VF linear) {
  const VF clamped =
      hn::IfThenElseZero(hn::Gt(linear, hn::Zero(F())), hn::Min(linear, hn::Set(F(), 1.0f)));
  const VF place =
      hn::Add(hn::Mul(hn::Sqrt(clamped), hn::Set(F(), float(kBytes - 1))), hn::Set(F(), 0.5f));
  return hn::GatherIndex(U(), table, hn::ConvertTo(I(), place));
}

void convert_colors(const std::uint32_t* table, const float* linear, int count,
                    std::uint32_t* bytes) {
  const int lanes = int(hn::Lanes(F()));
  const auto convert = [&](const float* from, std::uint32_t* to) {
    VF r, g, b, a;
    hn::LoadInterleaved4(F(), from, r, g, b, a);
    const VU red = bytes_of(table, r), green = bytes_of(table, g), blue = bytes_of(table, b);
    hn::StoreU(hn::Or(red, hn::Or(hn::ShiftLeft<8>(green), hn::ShiftLeft<16>(blue))), U(), to);
  };
  const int whole = count / lanes * lanes, rest = count - whole;
  for (int x = 0; x < whole; x += lanes) convert(linear + 4 * std::ptrdiff_t(x), bytes + x);
  if (rest == 0) return;
  float from[4 * kMaxLanes] = {};
  std::uint32_t to[kMaxLanes];
  std::copy_n(linear + 4 * std::ptrdiff_t(whole), 4 * rest, from);
  convert(from, to);
  std::copy_n(to, rest, bytes + whole);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {
namespace {

HWY_EXPORT(join_row);
HWY_EXPORT(convert_colors);

}  // namespace

void srgb_bytes_of(const glm::vec4* linear, int count, std::uint32_t* bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 4096> bytes_of{};
    for (int i = 0; i < 4096; ++i) {
      const float root = float(i) / 4095;
      bytes_of[std::size_t(i)] = std::uint32_t(srgb_from_linear(root * root) * 255 + 0.5f);
    }
    return bytes_of;
  }();
  if (count > 0) HWY_DYNAMIC_DISPATCH(convert_colors)(table.data(), &linear->x, count, bytes);
}

void inverses_of(const float* eye_z, int count, float* inverse_z) {
  for (int i = 0; i < count; ++i)
    inverse_z[i] = eye_z[i] < kNoDepth && eye_z[i] > 0 ? 1 / eye_z[i] : 0.0f;
}

void join_quarters(const QuarterRows& rows, int texels, bool smooth, const TexelRow& out) {
  HWY_DYNAMIC_DISPATCH(join_row)(rows, texels, smooth, out);
}

}  // namespace rilievo
#endif

// Powers are 2^(e log2 x):
//   x = 2^n m, m in [sqrt(1/2), sqrt(2)), s = (m - 1) / (m + 1), |s| < 0.172:
//     log2 x = n + 2 / ln 2 (s + s^3 / 3 + ... + s^9 / 9), whose next term is below 1e-9
//   2^y = 2^n e^(ln 2 f), f in [-1/2, 1/2]: seven terms of the series, the next below 6e-9
// so that three or four roundings of floats remain.
#include "rilievo/measure/flip_rows.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/measure/flip_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using F = hn::CappedTag<float, kFlipLanes>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;

HWY_INLINE VF set(float v) { return hn::Set(F(), v); }

HWY_INLINE VF log2_of(VF x) {
  const F f;
  const I i;
  const auto bits = hn::BitCast(i, x);
  // The exponent of x / sqrt(1/2), rounded down.
  const auto n = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(i, 0x3f3504f3)));
  const VF m = hn::BitCast(f, hn::Sub(bits, hn::ShiftLeft<23>(n)));
  const VF s = hn::Div(hn::Sub(m, set(1)), hn::Add(m, set(1))), t = hn::Mul(s, s);
  VF sum = set(1.0f / 9);
  for (const float term : {1.0f / 7, 1.0f / 5, 1.0f / 3, 1.0f})
    sum = hn::Add(hn::Mul(sum, t), set(term));
  return hn::Add(hn::ConvertTo(f, n), hn::Mul(set(2.885390082f), hn::Mul(s, sum)));
}

HWY_INLINE VF exp2_of(VF y) {
  const F f;
  const I i;
  const VF clamped = hn::Min(hn::Max(y, set(-126)), set(126)), n = hn::Round(clamped);
  const VF x = hn::Mul(hn::Sub(clamped, n), set(0.693147181f));
  VF sum = set(1.0f / 5040);
  for (const float term : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f})
    sum = hn::Add(hn::Mul(sum, x), set(term));
  const auto exponent = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(i, n), hn::Set(i, 127)));
  return hn::Mul(sum, hn::BitCast(f, exponent));
}

// x^e for x >= 0 and e > 0; 0 where x is subnormal.
HWY_INLINE VF power(VF x, VF e) {
  const VF raised = exp2_of(hn::Mul(e, log2_of(hn::Max(x, set(1.17549435e-38f)))));
  return hn::IfThenElseZero(hn::Gt(x, set(1.17549435e-38f)), raised);
}

HWY_INLINE VF lab_curve(VF t) {
  constexpr float kDelta = 6.0f / 29;
  const VF line = hn::Add(hn::Mul(t, set(1 / (3 * kDelta * kDelta))), set(4.0f / 29));
  return hn::IfThenElse(hn::Gt(t, set(kDelta * kDelta * kDelta)), power(t, set(1.0f / 3)), line);
}

HWY_INLINE VF distance(VF l, VF a, VF b) {
  const VF hyab = hn::Add(hn::Abs(l), hn::Sqrt(hn::Add(hn::Mul(a, a), hn::Mul(b, b))));
  return power(hyab, set(0.7f));
}

void filter(const FlipKernel& kernel, const float* const* in, int count, float* out) {
  const F f;
  const int lanes = int(hn::Lanes(f)), taps = int(kernel.size());
  int x = 0;
  for (; x + 4 * lanes <= count; x += 4 * lanes) {
    VF a = hn::Zero(f), b = a, c = a, d = a;
    for (int k = 0; k < taps; ++k) {
      const VF w = hn::Set(f, kernel[std::size_t(k)]);
      const float* const from = in[k] + x;
      a = hn::Add(a, hn::Mul(w, hn::LoadU(f, from)));
      b = hn::Add(b, hn::Mul(w, hn::LoadU(f, from + lanes)));
      c = hn::Add(c, hn::Mul(w, hn::LoadU(f, from + 2 * lanes)));
      d = hn::Add(d, hn::Mul(w, hn::LoadU(f, from + 3 * lanes)));
    }
    hn::StoreU(a, f, out + x);
    hn::StoreU(b, f, out + x + lanes);
    hn::StoreU(c, f, out + x + 2 * lanes);
    hn::StoreU(d, f, out + x + 3 * lanes);
  }
  for (; x < count; x += lanes) {
    VF sum = hn::Zero(f);
    for (int k = 0; k < taps; ++k)
      sum = hn::Add(sum, hn::Mul(hn::Set(f, kernel[std::size_t(k)]), hn::LoadU(f, in[k] + x)));
    hn::StoreU(sum, f, out + x);
  }
}

HWY_INLINE VF row_of(const glm::mat3& m, int row, VF x, VF y, VF z) {
  return hn::Add(hn::Add(hn::Mul(set(m[0][row]), x), hn::Mul(set(m[1][row]), y)),
                 hn::Mul(set(m[2][row]), z));
}

void see(const FlipColors& colors, const float* filtered, int count, float* seen, int pitch) {
  const F f;
  const auto of = [&](FlipFiltered plane, int x) {
    return hn::LoadU(f, filtered + plane * count + x);
  };
  const auto length = [&](VF a, VF b) { return hn::Sqrt(hn::Add(hn::Mul(a, a), hn::Mul(b, b))); };
  for (int at = 0; at < count; at += int(hn::Lanes(f))) {
    const VF yy = of(kYOut, at), xx = hn::Add(of(kCxOut, at), yy), zz = hn::Sub(yy, of(kCzOut, at));
    const auto rgb = [&](int row) {
      return hn::Min(hn::Max(row_of(colors.rgb_from_xyz, row, xx, yy, zz), set(0)), set(1));
    };
    const VF r = rgb(0), g = rgb(1), b = rgb(2);
    const VF x = lab_curve(row_of(colors.xyz_from_rgb, 0, r, g, b));
    const VF y = lab_curve(row_of(colors.xyz_from_rgb, 1, r, g, b));
    const VF z = lab_curve(row_of(colors.xyz_from_rgb, 2, r, g, b));
    const VF l = hn::Sub(hn::Mul(set(116), y), set(16)), hunt = hn::Mul(set(0.01f), l);
    const auto put = [&](FlipSeen plane, VF v) { hn::StoreU(v, f, seen + plane * pitch + at); };
    put(kLightness, l);
    put(kRed, hn::Mul(hunt, hn::Mul(set(500), hn::Sub(x, y))));
    put(kBlue, hn::Mul(hunt, hn::Mul(set(200), hn::Sub(y, z))));
    put(kEdge, length(of(kEdgeX, at), of(kEdgeY, at)));
    put(kPoint, length(of(kPointX, at), of(kPointY, at)));
  }
}

void compare(const float* truth, int truth_pitch, const float* frame, int frame_pitch, float most,
             int count, float* out) {
  const F f;
  constexpr float kBend = 0.4f, kBent = 0.95f;
  const float bend = kBend * most;
  for (int at = 0; at < count; at += int(hn::Lanes(f))) {
    const auto less = [&](FlipSeen plane) {
      return hn::Sub(hn::LoadU(f, truth + plane * truth_pitch + at),
                     hn::LoadU(f, frame + plane * frame_pitch + at));
    };
    const VF color = distance(less(kLightness), less(kRed), less(kBlue));
    const VF low = hn::Mul(set(kBent / bend), color);
    const VF high =
        hn::Add(set(kBent), hn::Mul(hn::Sub(color, set(bend)), set((1 - kBent) / (most - bend))));
    const VF d_color = hn::IfThenElse(hn::Lt(color, set(bend)), low, high);
    const VF feature = hn::Max(hn::Abs(less(kEdge)), hn::Abs(less(kPoint)));
    const VF d_feature = hn::Sqrt(hn::Mul(feature, set(0.707106781f)));
    const VF flip = power(d_color, hn::Sub(set(1), d_feature));
    hn::StoreU(flip, f, out + at);
  }
}

float distance_of(const glm::vec3& lab, const glm::vec3& other) {
  const glm::vec3 d = lab - other;
  return hn::GetLane(distance(set(d.x), set(d.y), set(d.z)));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(filter);
HWY_EXPORT(see);
HWY_EXPORT(compare);
HWY_EXPORT(distance_of);

void flip_filter(const FlipKernel& kernel, const float* const* in, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(filter)(kernel, in, count, out);
}

void flip_see(const FlipColors& colors, const float* filtered, int count, float* seen, int pitch) {
  HWY_DYNAMIC_DISPATCH(see)(colors, filtered, count, seen, pitch);
}

void flip_compare(const float* truth, int truth_pitch, const float* frame, int frame_pitch,
                  float most, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(compare)(truth, truth_pitch, frame, frame_pitch, most, count, out);
}

float flip_distance(const glm::vec3& lab, const glm::vec3& other) {
  return HWY_DYNAMIC_DISPATCH(distance_of)(lab, other);
}

}  // namespace rilievo
#endif

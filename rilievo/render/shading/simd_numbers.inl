// Numbers of several lanes, so that formulas can be read; the shading model (shading_model.inl) is
// a template over them. Nothing is fused: the same bytes on every machine. Included once for each
// instruction set, within HWY_NAMESPACE.

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;

struct vmask {
  hn::Mask<F> m;
};

struct vfloat {
  hn::Vec<F> v;
  vfloat() = default;
  HWY_INLINE vfloat(hn::Vec<F> v) : v(v) {}
  HWY_INLINE vfloat(float x) : v(hn::Set(F(), x)) {}
};
HWY_INLINE vfloat operator+(vfloat a, vfloat b) { return hn::Add(a.v, b.v); }
HWY_INLINE vfloat operator-(vfloat a, vfloat b) { return hn::Sub(a.v, b.v); }
HWY_INLINE vfloat operator*(vfloat a, vfloat b) { return hn::Mul(a.v, b.v); }
HWY_INLINE vfloat operator/(vfloat a, vfloat b) { return hn::Div(a.v, b.v); }
HWY_INLINE vfloat min(vfloat a, vfloat b) { return hn::Min(a.v, b.v); }
HWY_INLINE vfloat max(vfloat a, vfloat b) { return hn::Max(a.v, b.v); }
HWY_INLINE vfloat clamp(vfloat a, float low, float high) { return min(max(a, low), high); }
HWY_INLINE vfloat sqrt(vfloat a) { return hn::Sqrt(a.v); }
HWY_INLINE vfloat floor(vfloat a) { return hn::Floor(a.v); }
HWY_INLINE vfloat round(vfloat a) { return hn::Round(a.v); }  // to even
HWY_INLINE vmask operator<(vfloat a, vfloat b) { return {hn::Lt(a.v, b.v)}; }
HWY_INLINE vmask operator<=(vfloat a, vfloat b) { return {hn::Le(a.v, b.v)}; }
HWY_INLINE vmask operator&(vmask a, vmask b) { return {hn::And(a.m, b.m)}; }
HWY_INLINE bool any(vmask a) { return !hn::AllFalse(F(), a.m); }
HWY_INLINE bool all(vmask a) { return hn::AllTrue(F(), a.m); }
HWY_INLINE vfloat select(vmask m, vfloat yes, vfloat no) {
  return hn::IfThenElse(m.m, yes.v, no.v);
}

struct vint {
  hn::Vec<I> v;
  vint() = default;
  HWY_INLINE vint(hn::Vec<I> v) : v(v) {}
  HWY_INLINE vint(int x) : v(hn::Set(I(), x)) {}
};
HWY_INLINE vint operator+(vint a, vint b) { return hn::Add(a.v, b.v); }
HWY_INLINE vint operator-(vint a, vint b) { return hn::Sub(a.v, b.v); }
HWY_INLINE vint operator*(vint a, vint b) { return hn::Mul(a.v, b.v); }
HWY_INLINE vint min(vint a, vint b) { return hn::Min(a.v, b.v); }
HWY_INLINE vint max(vint a, vint b) { return hn::Max(a.v, b.v); }
HWY_INLINE vmask operator<(vint a, vint b) { return {hn::RebindMask(F(), hn::Lt(a.v, b.v))}; }
HWY_INLINE vint select(vmask m, vint yes, vint no) {
  return hn::IfThenElse(hn::RebindMask(I(), m.m), yes.v, no.v);
}
HWY_INLINE vint shift_right(vint a, vint by) { return hn::Shr(a.v, by.v); }  // 0 <= by < 32
// Byte k of four.
template <int k>
HWY_INLINE vint byte_of(vint a) {
  if constexpr (k == 3)
    return hn::BitCast(I(), hn::ShiftRight<24>(hn::BitCast(hn::RebindToUnsigned<F>(), a.v)));
  else
    return hn::And(hn::ShiftRight<8 * k>(a.v), hn::Set(I(), 255));
}

template <class T>
struct IntOfNumber;
template <>
struct IntOfNumber<vfloat> {
  using type = vint;
};

HWY_INLINE vint to_int(vfloat a) { return hn::ConvertTo(I(), a.v); }  // towards zero
HWY_INLINE vfloat to_number(vfloat, vint a) { return hn::ConvertTo(F(), a.v); }
HWY_INLINE vint gather(const std::int32_t* base, vint at) {
  return hn::GatherIndex(I(), base, at.v);
}
// 2 to a whole number, a > 0 split into a number in [1, 2) and its power of two.
HWY_INLINE vfloat power_of_two(vfloat, vint whole) {
  return hn::BitCast(F(), hn::ShiftLeft<23>(hn::Add(whole.v, hn::Set(I(), 127))));
}
HWY_INLINE vfloat split_power(vfloat a, vint& whole) {
  const auto bits = hn::BitCast(I(), a.v);
  whole = hn::Sub(hn::ShiftRight<23>(bits), hn::Set(I(), 127));
  return hn::BitCast(F(),
                     hn::Or(hn::And(bits, hn::Set(I(), 0x007FFFFF)), hn::Set(I(), 0x3F800000)));
}

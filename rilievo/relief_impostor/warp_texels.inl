// What both passes of the pre-warp do with texels (warp_rows.cpp, warp_columns.cpp), which include
// it once for each instruction set: what lies between the ends of pieces, and silhouettes, which
// are few and drawn one by one.

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
    between(a, b, bits_a, bits_b, reach, center_of(lane_numbers(I(), x)), color, code);
    put(color, code, x, std::min(lanes, end - x));
  }
}

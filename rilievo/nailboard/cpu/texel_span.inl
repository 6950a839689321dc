// Which texels do neighbouring pixels show, and what is between four of them? For compose_tile.cpp,
// within its namespace: compiled once for each instruction set. Internal: not a stable interface.

using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using MF = hn::Mask<F>;

constexpr int kBlock = FrameTile::kBlock, kPixels = FrameTile::kBlockPixels;

// Texels of neighbouring pixels are neighbours, too. A row of 8 pixels mostly takes its texels from
// 16 columns of one or two rows of texels: those are loaded as they lie, and permuted. That beats
// gathering them one by one; where they lie farther apart, they are gathered.
#if HWY_TARGET == HWY_SCALAR
constexpr int kLanes = 1;
#else
constexpr int kLanes = int(hn::MaxLanes(F()));
#endif
constexpr int kRows = std::max(1, kLanes / kBlock);  // of pixels in a vector
constexpr int kSpan = 16;                            // texels
static_assert(kSpan <= MemoryNailboard::kReadBeyond);

// The texels of a vector of pixels.
struct Span {
  VI column, row;        // of each
  bool near = false;     // they lie in the spans from `first_...` on, in this row and the next
  bool one_row = false;  // in this row only
  int first_column[kRows], first_row[kRows];
};

HWY_INLINE Span span_of(VI column, VI row) {
  Span span{column, row};
  if constexpr (kLanes >= kBlock) {
    const I i32;
    HWY_ALIGN std::int32_t columns[kLanes], rows[kLanes];
    hn::Store(column, i32, columns);
    hn::Store(row, i32, rows);
    span.near = span.one_row = true;
    for (int r = 0; r < kRows; ++r) {
      // Monotone along a row of pixels: the ends are the extremes.
      const int a = r * kBlock, b = a + kBlock - 1;
      span.first_column[r] = std::min(columns[a], columns[b]);
      span.first_row[r] = std::min(rows[a], rows[b]);
      const int wide = std::abs(columns[a] - columns[b]), high = std::abs(rows[a] - rows[b]);
      span.near = span.near && wide <= kSpan - 2 && high <= 1;
      span.one_row = span.one_row && high == 0;
    }
  }
  return span;
}

// One number for each row of pixels of a vector.
HWY_INLINE VI by_row(const int* values) {
  const I i32;
  if constexpr (kRows == 2)
    return hn::IfThenElse(hn::FirstN(i32, kBlock), hn::Set(i32, values[0]),
                          hn::Set(i32, values[1]));
  return hn::Set(i32, values[0]);
}

// Words of a table of `kSpan` for each row of pixels, at words + first[row].
HWY_INLINE VU look_up(const std::uint32_t* words, const int* first, VI index) {
  const U u32;
#if HWY_TARGET == HWY_SCALAR
  return hn::GatherIndex(u32, words + first[0], index);
#else
  if constexpr (kRows == 2) {
    const auto at = hn::IndicesFromVec(u32, index);
    return hn::IfThenElse(hn::FirstN(u32, kBlock),
                          hn::TableLookupLanes(hn::LoadU(u32, words + first[0]), at),
                          hn::TableLookupLanes(hn::LoadU(u32, words + first[1]), at));
  } else if constexpr (kLanes == kBlock) {
    const I i32;
    const auto at = hn::IndicesFromVec(u32, hn::And(index, hn::Set(i32, kBlock - 1)));
    const auto low = hn::RebindMask(u32, hn::Lt(index, hn::Set(i32, kBlock)));
    return hn::IfThenElse(
        low, hn::TableLookupLanes(hn::LoadU(u32, words + first[0]), at),
        hn::TableLookupLanes(hn::LoadU(u32, words + first[0] + kBlock), at));
  }
  return hn::GatherIndex(u32, words + first[0], index);
#endif
}

// The code of each texel.
HWY_INLINE VU codes_of(const MemoryNailboard& picture, const Span& span) {
  const I i32;
  const U u32;
  const int stride = picture.stride();
  const VI texel = hn::Add(hn::Mul(span.row, hn::Set(i32, stride)), span.column);
  VU pair;
  if (span.near) {
    int first[kRows], next[kRows];
    for (int r = 0; r < kRows; ++r) {
      first[r] = (span.first_row[r] * stride + span.first_column[r]) / 2;
      next[r] = first[r] + stride / 2;
    }
    const VI in_row = hn::And(
        hn::Sub(hn::ShiftRight<1>(span.column), hn::ShiftRight<1>(by_row(span.first_column))),
        hn::Set(i32, kSpan - 1));
    pair = look_up(picture.code_pairs(), first, in_row);
    if (!span.one_row) {
      const auto upper = hn::RebindMask(u32, hn::Eq(span.row, by_row(span.first_row)));
      pair = hn::IfThenElse(upper, pair, look_up(picture.code_pairs(), next, in_row));
    }
  } else {
    pair = hn::GatherIndex(u32, picture.code_pairs(), hn::ShiftRight<1>(texel));
  }
  const auto odd = hn::TestBit(hn::BitCast(u32, span.column), hn::Set(u32, 1));
  return hn::And(hn::IfThenElse(odd, hn::ShiftRight<16>(pair), pair), hn::Set(u32, 0xffffu));
}

// Each texel, and those to the right, below, and below to the right.
struct Four {
  VU a, b, c, d;
};

HWY_INLINE Four colors_of(const MemoryNailboard& picture, const Span& span) {
  const I i32;
  const U u32;
  const int stride = picture.stride();
  const std::uint32_t* above = picture.color();
  const std::uint32_t* below = above + stride;
  if (!span.near) {
    const VI texel = hn::Add(hn::Mul(span.row, hn::Set(i32, stride)), span.column);
    return {hn::GatherIndex(u32, above, texel), hn::GatherIndex(u32, above + 1, texel),
            hn::GatherIndex(u32, below, texel), hn::GatherIndex(u32, below + 1, texel)};
  }
  int first[kRows];
  for (int r = 0; r < kRows; ++r)
    first[r] = span.first_row[r] * stride + span.first_column[r];
  const VI last = hn::Set(i32, kSpan - 1);
  const VI left = hn::And(hn::Sub(span.column, by_row(span.first_column)), last);
  const VI right = hn::And(hn::Add(left, hn::Set(i32, 1)), last);
  const Four upper{look_up(above, first, left), look_up(above, first, right),
                   look_up(below, first, left), look_up(below, first, right)};
  if (span.one_row) return upper;
  const auto is_upper = hn::RebindMask(u32, hn::Eq(span.row, by_row(span.first_row)));
  const std::uint32_t* third = below + stride;
  return {hn::IfThenElse(is_upper, upper.a, upper.c), hn::IfThenElse(is_upper, upper.b, upper.d),
          hn::IfThenElse(is_upper, upper.c, look_up(third, first, left)),
          hn::IfThenElse(is_upper, upper.d, look_up(third, first, right))};
}

// Arithmetic on two channels a lane, 16 bits each: color 128 in 0 ... kOne.
#if HWY_TARGET == HWY_SCALAR
// Its vectors have one number.
template <class Channel>
HWY_INLINE VU each_half(const Channel& channel) {
  return hn::Set(U(), std::uint32_t(channel(0)) | std::uint32_t(channel(16)) << 16);
}
HWY_INLINE int half_of(VU pair, int shift) { return int(hn::GetLane(pair) >> shift & 0xffffu); }

HWY_INLINE VU mix(VU from, VU to, VU weight) {
  return each_half([&](int at) {
    const int a = half_of(from, at), b = half_of(to, at);
    return a + (((b - a) * half_of(weight, at) + (1 << 14)) >> 15);
  });
}
HWY_INLINE VU to_bytes(VU pair) {
  return each_half([&](int at) { return (half_of(pair, at) + 64) >> 7; });
}
HWY_INLINE VU divide(VU pair, VU factor) {
  return each_half([&](int at) {
    const std::uint32_t product =
        2u * std::uint32_t(half_of(pair, at)) * std::uint32_t(half_of(factor, at));
    return std::min(((product >> 16) + 8) >> 4, 255u);
  });
}
#else
using S = hn::Repartition<std::int16_t, F>;
using US = hn::RebindToUnsigned<S>;

// From `from` to `to` by a weight of 15 bits.
HWY_INLINE VU mix(VU from, VU to, VU weight) {
  const S s;
  const auto a = hn::BitCast(s, from), b = hn::BitCast(s, to), w = hn::BitCast(s, weight);
  return hn::BitCast(U(), hn::Add(a, hn::MulFixedPoint15(hn::Sub(b, a), w)));
}
// Rounded to the nearest byte.
HWY_INLINE VU to_bytes(VU pair) {
  const US s;
  return hn::BitCast(U(), hn::ShiftRight<7>(hn::Add(hn::BitCast(s, pair), hn::Set(s, 64))));
}
// By alpha, to the nearest byte. `factor` is 4096 kOne / alpha: 2 color factor / 2^16 is 16 bytes.
HWY_INLINE VU divide(VU pair, VU factor) {
  const US s;
  const auto sixteenths =
      hn::MulHigh(hn::ShiftLeft<1>(hn::BitCast(s, pair)), hn::BitCast(s, factor));
  return hn::BitCast(
      U(), hn::Min(hn::ShiftRight<4>(hn::Add(sixteenths, hn::Set(s, 8))), hn::Set(s, 255)));
}
#endif

// Two channels of the 4 texels around a point.
HWY_INLINE VU between(VU a, VU b, VU c, VU d, VU x, VU y) {
  return mix(mix(a, b, x), mix(c, d, x), y);
}

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
static_assert(kSpan <= SoftwareNailboard::kReadBeyond);

// The texels of every row of a block's pixels: in how many columns, of how many rows of texels?
enum class Reach {
  any,    // nothing is known
  steep,  // kBlock, and their right neighbours, of three rows
  span,   // kSpan, and their right neighbours, of two rows
  block,  // kBlock, and their right neighbours, of two rows
};

// Where the texels of a vector of pixels begin: for each row of pixels the first column and the
// upmost row.
struct Span {
  VI column;            // of each texel
  VI in_span, in_rows;  // its column and its row, less the first ones
  int first[kRows];     // the texel in the first column of the upmost row
};

#if HWY_TARGET == HWY_SCALAR
constexpr bool kSpans = false;
#else
constexpr bool kSpans = kLanes >= kBlock;
#endif

// Of the two ends of each row of pixels the left one, and the right one.
struct Ends {
  HWY_ALIGN std::int32_t left[16], right[16];
  constexpr Ends() : left(), right() {
    for (int i = 0; i < 16; ++i) left[i] = i / kBlock * kBlock, right[i] = left[i] + kBlock - 1;
  }
};
constexpr Ends kEnds;

// Requires kSpans, and a row of pixels whose texels reach no farther than `Reach::span`.
HWY_INLINE Span span_of(const SoftwareNailboard& picture, VI column, VI row) {
  const I i32;
  // Monotone along a row of pixels: the ends are the extremes.
  const auto left = hn::SetTableIndices(i32, kEnds.left),
             right = hn::SetTableIndices(i32, kEnds.right);
  const auto least = [&](VI a) {
    return hn::Min(hn::TableLookupLanes(a, left), hn::TableLookupLanes(a, right));
  };
  const VI first_column = least(column), first_row = least(row);
  Span span{column, hn::Sub(column, first_column), hn::Sub(row, first_row), {}};
  const VI first = hn::Add(hn::Mul(first_row, hn::Set(i32, picture.stride())), first_column);
  span.first[0] = hn::GetLane(first);
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kRows == 2) span.first[1] = hn::GetLane(hn::UpperHalf(hn::Half<I>(), first));
#endif
  return span;
}

// Words of a table for each row of pixels, at words + first[row]: kBlock or kSpan of them.
template <Reach reach>
HWY_INLINE VU look_up(const std::uint32_t* words, const int* first, VI index) {
  const U u32;
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kRows == 2) {
    if constexpr (reach != Reach::span) {
      const hn::Half<U> half;
      const I i32;
      HWY_ALIGN static constexpr std::int32_t kSecond[16] = {0, 0, 0, 0, 0, 0, 0, 0,
                                                             8, 8, 8, 8, 8, 8, 8, 8};
      const VU table =
          hn::Combine(u32, hn::LoadU(half, words + first[1]), hn::LoadU(half, words + first[0]));
      return hn::TableLookupLanes(table,
                                  hn::IndicesFromVec(u32, hn::Or(index, hn::Load(i32, kSecond))));
    }
    const auto at = hn::IndicesFromVec(u32, index);
    return hn::IfThenElse(hn::FirstN(u32, kBlock),
                          hn::TableLookupLanes(hn::LoadU(u32, words + first[0]), at),
                          hn::TableLookupLanes(hn::LoadU(u32, words + first[1]), at));
  } else if constexpr (kLanes == kBlock) {
    const I i32;
    if constexpr (reach != Reach::span)
      return hn::TableLookupLanes(hn::LoadU(u32, words + first[0]), hn::IndicesFromVec(u32, index));
    const auto at = hn::IndicesFromVec(u32, hn::And(index, hn::Set(i32, kBlock - 1)));
    const auto low = hn::RebindMask(u32, hn::Lt(index, hn::Set(i32, kBlock)));
    return hn::IfThenElse(low, hn::TableLookupLanes(hn::LoadU(u32, words + first[0]), at),
                          hn::TableLookupLanes(hn::LoadU(u32, words + first[0] + kBlock), at));
  }
#endif
  return hn::GatherIndex(u32, words + first[0], index);
}

// Which texels lie below this row of the span?
template <int above>
HWY_INLINE hn::Mask<U> is_below(const Span& span) {
  return hn::RebindMask(U(), hn::Gt(span.in_rows, hn::Set(I(), above)));
}

// The code of each texel.
template <Reach reach>
HWY_INLINE VU codes_of(const SoftwareNailboard& picture, VI column, VI row) {
  const I i32;
  const U u32;
  const int stride = picture.stride();
  VU pair;
  if constexpr (reach != Reach::any && kSpans) {
    const Span span = span_of(picture, column, row);
    // Pairs begin at even columns, and rows with one.
    const VI odd_start = hn::And(hn::Sub(column, span.in_span), hn::Set(i32, 1));
    const VI in_pairs = hn::ShiftRight<1>(hn::Add(span.in_span, odd_start));
    const auto look = [&](int down) {
      int first[kRows];
      for (int r = 0; r < kRows; ++r) first[r] = (span.first[r] + down * stride) / 2;
      return look_up<reach>(picture.code_pairs(), first, in_pairs);
    };
    pair = hn::IfThenElse(is_below<0>(span), look(1), look(0));
    if constexpr (reach == Reach::steep) pair = hn::IfThenElse(is_below<1>(span), look(2), pair);
  } else {
    const VI texel = hn::Add(hn::Mul(row, hn::Set(i32, stride)), column);
    pair = hn::GatherIndex(u32, picture.code_pairs(), hn::ShiftRight<1>(texel));
  }
  const auto odd = hn::TestBit(hn::BitCast(u32, column), hn::Set(u32, 1));
  return hn::And(hn::IfThenElse(odd, hn::ShiftRight<16>(pair), pair), hn::Set(u32, 0xffffu));
}

// Each texel, and those to the right, below, and below to the right.
struct Four {
  VU a, b, c, d;
};

template <Reach reach>
HWY_INLINE Four colors_of(const SoftwareNailboard& picture, VI column, VI row) {
  const I i32;
  const U u32;
  const int stride = picture.stride();
  const std::uint32_t* above = picture.color();
  const std::uint32_t* below = above + stride;
  if constexpr (reach == Reach::any || !kSpans) {
    const VI texel = hn::Add(hn::Mul(row, hn::Set(i32, stride)), column);
    return {hn::GatherIndex(u32, above, texel), hn::GatherIndex(u32, above + 1, texel),
            hn::GatherIndex(u32, below, texel), hn::GatherIndex(u32, below + 1, texel)};
  } else {
    const Span span = span_of(picture, column, row);
    const auto look = [&](int right, int down) {
      return look_up<reach>(above + down * stride + right, span.first, span.in_span);
    };
    const auto second = is_below<0>(span);
    const VU b0 = look(0, 1), b1 = look(1, 1), c0 = look(0, 2), c1 = look(1, 2);
    Four four{hn::IfThenElse(second, b0, look(0, 0)), hn::IfThenElse(second, b1, look(1, 0)),
              hn::IfThenElse(second, c0, b0), hn::IfThenElse(second, c1, b1)};
    if constexpr (reach == Reach::steep) {
      const auto third = is_below<1>(span);
      four = {hn::IfThenElse(third, c0, four.a), hn::IfThenElse(third, c1, four.b),
              hn::IfThenElse(third, look(0, 3), four.c), hn::IfThenElse(third, look(1, 3), four.d)};
    }
    return four;
  }
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

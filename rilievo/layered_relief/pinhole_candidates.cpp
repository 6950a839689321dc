// Along a line let b_i be the Delta of the i-th texel on one side, and a_j that of the j-th on the
// other. A gap of at most n texels has its ends i and j texels away with i + j <= n + 1, and they
// are of one surface, so the texel lies in one only if it is behind
//
//   min over i + j <= n + 1, |b_i - a_j| <= ends, of max(b_i, a_j)
//
// Where leaves lie in random depths nearly every texel has something in front on both sides, but
// few have two neighbours of one surface there.
#include "rilievo/layered_relief/pinhole_candidates.h"

#include <algorithm>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/layered_relief/fill_pinholes.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/layered_relief/pinhole_candidates.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using U16 = hn::CappedTag<std::uint16_t, 32>;

// That minimum, of the texels at `row`, along a line with that stride.
HWY_INLINE hn::Vec<U16> nearest_ends(const std::uint16_t* row, std::ptrdiff_t stride, int widest,
                                     hn::Vec<U16> ends) {
  const U16 d;
  const auto none = hn::Set(d, 0xffff);
  auto least = none;
  for (int i = 1; i <= widest; ++i) {
    const auto before = hn::LoadU(d, row - i * stride);
    for (int j = 1; j <= widest + 1 - i; ++j) {
      const auto after = hn::LoadU(d, row + j * stride);
      const auto farther = hn::Max(before, after);
      const auto apart = hn::Sub(farther, hn::Min(before, after));
      least = hn::Min(least, hn::IfThenElse(hn::Gt(apart, ends), none, farther));
    }
  }
  return least;
}

// Does each line have something in front on both sides?
HWY_INLINE hn::Mask<U16> surrounded(const std::uint16_t* row, std::ptrdiff_t width,
                                    hn::Mask<U16> behind, hn::Vec<U16> in_front) {
  const U16 d;
  for (const std::ptrdiff_t stride : {width, std::ptrdiff_t(1), width + 1, width - 1}) {
    auto before = hn::LoadU(d, row - stride), after = hn::LoadU(d, row + stride);
    for (int i = 2; i <= kPinholeReach; ++i) {
      before = hn::Min(before, hn::LoadU(d, row - i * stride));
      after = hn::Min(after, hn::LoadU(d, row + i * stride));
    }
    behind = hn::And(behind, hn::Gt(in_front, hn::Max(before, after)));
    if (hn::AllFalse(d, behind)) break;
  }
  return behind;
}

std::size_t find_candidates(const std::uint16_t* delta, int width, int height, int y, int step,
                            int ends, int widest, std::int32_t* columns) {
  const U16 d;
  const int lanes = int(hn::Lanes(d));
  const bool inside = y >= widest && y + widest < height && width >= 2 * widest + lanes;
  const bool rows_around = y >= kPinholeReach && y + kPinholeReach < height;
  const std::uint16_t* const row = delta + std::ptrdiff_t(y) * width;
  std::size_t count = 0;
  int x = 1;
  for (; x < (inside ? widest : width - 1); ++x) columns[count++] = x;
  if (!inside) return count;
  const auto by = hn::Set(d, std::uint16_t(std::min(step, 0xffff)));
  const auto apart = hn::Set(d, std::uint16_t(std::min(ends, 0xffff)));
  const int end = width - widest;
  for (; x < end; x += lanes) {
    const int from = std::min(x, end - lanes);  // the last ones again
    auto least = nearest_ends(row + from, 1, widest, apart);
    for (const std::ptrdiff_t stride : {width, width + 1, width - 1})
      least = hn::Min(least, nearest_ends(row + from, stride, widest, apart));
    const auto in_front = hn::SaturatedSub(hn::LoadU(d, row + from), by);
    auto behind = hn::Gt(in_front, least);
    if (hn::AllFalse(d, behind)) continue;
    if (rows_around && from >= kPinholeReach && from + lanes + kPinholeReach <= width)
      behind = surrounded(row + from, width, behind, in_front);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, behind, bits);
    for (int i = x - from; i < lanes; ++i)
      if (bits[i / 8] >> (i % 8) & 1) columns[count++] = from + i;
  }
  for (x = std::max(end, 1); x < width - 1; ++x) columns[count++] = x;
  return count;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(find_candidates);

std::size_t pinhole_candidates(const std::uint16_t* delta, int width, int height, int y, int step,
                               int ends, int widest, std::int32_t* columns) {
  RILIEVO_EXPECTS(widest >= 1);
  return HWY_DYNAMIC_DISPATCH(find_candidates)(delta, width, height, y, step, ends, widest,
                                               columns);
}

}  // namespace rilievo
#endif

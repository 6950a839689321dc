// Few texels lie along silhouettes: what is covered around each of a row is found many at a time,
// and those that are all inside, or all outside, are passed over.
#include "rilievo/layered_relief/soften_silhouettes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/parallel_for.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/layered_relief/soften_silhouettes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using Wide = hn::CappedTag<std::uint32_t, 16>;
using Narrow = hn::Rebind<std::uint16_t, Wide>;

constexpr std::uint16_t kUncovered = delta_transparent(16);
constexpr std::uint16_t kAllCovered = 16;

// 1 2 1 of what is covered above, at and below each of `width` columns.
void sum_columns(const std::uint16_t* above, const std::uint16_t* own, const std::uint16_t* below,
                 int width, std::uint16_t* sums) {
  const Narrow d;
  const auto one = hn::Set(d, 1);
  const auto covered = [&](const std::uint16_t* delta) HWY_ATTR {
    return hn::Min(hn::Sub(hn::Set(d, kUncovered), hn::LoadU(d, delta)), one);
  };
  const int lanes = int(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto at = covered(own + x);
    const auto around = hn::Add(covered(above + x), covered(below + x));
    hn::StoreU(hn::Add(around, hn::Add(at, at)), d, sums + x);
  }
  for (; x < width; ++x)
    sums[x] = std::uint16_t((above[x] != kUncovered) + 2 * (own[x] != kUncovered) +
                            (below[x] != kUncovered));
}

// `sum` of 16 shares of colours, two channels at once: 16 bits hold 16 times a byte.
template <typename D>
HWY_INLINE hn::Vec<D> share_of(D d, hn::Vec<D> color, hn::Vec<D> sum) {
  const auto bytes = hn::Set(d, 0x00ff00ff), half = hn::Set(d, 0x00080008);
  const auto even = hn::Add(hn::Mul(hn::And(color, bytes), sum), half);
  const auto odd = hn::Add(hn::Mul(hn::And(hn::ShiftRight<8>(color), bytes), sum), half);
  return hn::Or(hn::And(hn::ShiftRight<4>(even), bytes),
                hn::ShiftLeft<8>(hn::And(hn::ShiftRight<4>(odd), bytes)));
}

// Colours of a row get their shares; `sums` has one more column on both sides.
void share_row(const std::uint16_t* own, const std::uint16_t* sums, int width,
               std::uint32_t* colors) {
  const Wide wide;
  const Narrow d;
  const int lanes = int(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto at = hn::LoadU(d, sums + x + 1);
    const auto sum =
        hn::Add(hn::Add(hn::LoadU(d, sums + x), hn::LoadU(d, sums + x + 2)), hn::Add(at, at));
    const auto is_covered = hn::Ne(hn::LoadU(d, own + x), hn::Set(d, kUncovered));
    if (hn::AllFalse(d, hn::And(is_covered, hn::Ne(sum, hn::Set(d, kAllCovered))))) continue;
    hn::StoreU(share_of(wide, hn::LoadU(wide, colors + x), hn::PromoteTo(wide, sum)), wide,
               colors + x);
  }
  const hn::CappedTag<std::uint32_t, 1> single;
  for (; x < width; ++x) {
    const std::uint32_t sum = sums[x] + 2u * sums[x + 1] + sums[x + 2];
    hn::StoreU(share_of(single, hn::LoadU(single, colors + x), hn::Set(single, sum)), single,
               colors + x);
  }
}

void soften_rows(Prewarped& picture, int begin, int end, std::vector<std::uint16_t>& sums) {
  const int width = picture.width(), height = picture.height();
  sums.resize(std::size_t(width) + 2);
  const auto row = [&](int y) {
    return picture.delta.data() + std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width);
  };
  for (int y = begin; y < end; ++y) {
    sum_columns(row(y - 1), row(y), row(y + 1), width, sums.data() + 1);
    sums.front() = sums[1], sums.back() = sums[std::size_t(width)];
    share_row(row(y), sums.data(), width,
              reinterpret_cast<std::uint32_t*>(picture.color.data()) +
                  std::size_t(y) * std::size_t(width));
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {
namespace {

constexpr int kSoftenedTexels = 1 << 16;  // of a strip: fewer take less time than to share them

}  // namespace

HWY_EXPORT(soften_rows);

void soften_silhouettes(Prewarped& picture) {
  const int height = picture.height();
  const int rows_each = std::max(1, kSoftenedTexels / std::max(1, picture.width()));
  parallel_for(0, (height + rows_each - 1) / rows_each, [&](int strip) {
    static thread_local std::vector<std::uint16_t> sums;  // kept: a steady frame allocates nothing
    const int begin = strip * rows_each;
    HWY_DYNAMIC_DISPATCH(soften_rows)(picture, begin, std::min(begin + rows_each, height), sums);
  });
}

}  // namespace rilievo
#endif

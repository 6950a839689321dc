// Most vectors of texels have no empty one.
#include "rilievo/nailboard/nearest_beside.h"

#include <algorithm>

#include "rilievo/core/depth.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/nailboard/nearest_beside.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using U16 = hn::CappedTag<std::uint16_t, 32>;

constexpr std::uint16_t kEmpty = delta_transparent(16);

// Of the lanes from `x`, all of which have texels on both sides.
template <typename D>
HWY_INLINE void find_beside(D d, const std::uint16_t* above, const std::uint16_t* own,
                            const std::uint16_t* below, int x, std::uint16_t* codes) {
  auto code = hn::LoadU(d, own + x);
  const auto empty = hn::Eq(code, hn::Set(d, kEmpty));
  if (!hn::AllFalse(d, empty)) {
    const auto across = [&](const std::uint16_t* row) HWY_ATTR {
      const auto sides = hn::Min(hn::LoadU(d, row + x - 1), hn::LoadU(d, row + x + 1));
      return hn::Min(sides, hn::LoadU(d, row + x));
    };
    const auto around = hn::Min(hn::Min(across(above), across(below)), across(own));
    code = hn::IfThenElse(empty, around, code);
  }
  hn::StoreU(code, d, codes + x);
}

void find_row(const std::uint16_t* above, const std::uint16_t* own, const std::uint16_t* below,
              int width, std::uint16_t* codes) {
  const U16 d;
  const int lanes = int(hn::Lanes(d)), end = width - 1;
  int x = 1;
  for (; x + lanes <= end; x += lanes) find_beside(d, above, own, below, x, codes);
  if (x < end && end > lanes) {
    find_beside(d, above, own, below, end - lanes, codes);  // some of them again
    return;
  }
  for (; x < end; ++x) find_beside(hn::CappedTag<std::uint16_t, 1>(), above, own, below, x, codes);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(find_row);

void nearest_beside(const std::uint16_t* above, const std::uint16_t* own,
                    const std::uint16_t* below, int width, std::uint16_t* codes) {
  HWY_DYNAMIC_DISPATCH(find_row)(above, own, below, width, codes);
}

}  // namespace rilievo
#endif

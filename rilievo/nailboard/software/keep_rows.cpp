// A row is read once and written once: pictures of a frame are larger than the cache, and what
// copies them waits for memory.
#include "rilievo/nailboard/software/keep_rows.h"

#include <cstring>

#include "rilievo/core/expects.h"
#include "rilievo/nailboard/software/software_nailboard.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/nailboard/software/keep_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

using Texels = hn::CappedTag<std::uint32_t, 16>;
using Codes = hn::Rebind<std::uint16_t, Texels>;

// Keeps the texels from column `x` on, one a lane; `shown`: these are of the picture.
template <bool first>
HWY_INLINE void keep_lanes(hn::Vec<Texels> texels, hn::Mask<Codes> shown,
                           const std::uint16_t* codes, int x, std::uint32_t* color,
                           std::uint16_t* nearest, std::uint16_t* farthest, std::uint16_t* alpha) {
  const Texels wide;
  const Codes d;
  const auto code = hn::LoadU(d, codes + x);
  hn::StoreU(texels, wide, color + x);
  auto near = code, far = hn::IfThenElseZero(shown, code);
  auto covers = hn::IfThenElse(
      shown, hn::DemoteTo(d, hn::BitCast(hn::RebindToSigned<Texels>(), hn::ShiftRight<24>(texels))),
      hn::Set(d, 255));
  if (!first) {
    near = hn::Min(near, hn::LoadU(d, nearest + x));
    far = hn::Max(far, hn::LoadU(d, farthest + x));
    covers = hn::Min(covers, hn::LoadU(d, alpha + x));
  }
  hn::StoreU(near, d, nearest + x);
  hn::StoreU(far, d, farthest + x);
  hn::StoreU(covers, d, alpha + x);
}

template <bool first>
void keep(const std::uint32_t* texels, const std::uint16_t* codes, int width, int stride,
          std::uint32_t* color, BandColumns& columns) {
  const Texels wide;
  const Codes d;
  std::uint16_t* const nearest = columns.nearest.data();
  std::uint16_t* const farthest = columns.farthest.data();
  std::uint16_t* const alpha = columns.alpha.data();
  const int lanes = int(hn::Lanes(wide));
  const auto all = hn::FirstN(d, std::size_t(lanes));
  int x = 0;
  for (; x + lanes <= width; x += lanes)
    keep_lanes<first>(hn::LoadU(wide, texels + x), all, codes, x, color, nearest, farthest, alpha);
  for (; x < stride; x += lanes) {
    std::uint32_t rest[16] = {};
    const int shown = x < width ? width - x : 0;
    std::memcpy(rest, texels + (shown ? x : 0), std::size_t(shown) * sizeof *rest);
    keep_lanes<first>(hn::LoadU(wide, rest), hn::FirstN(d, std::size_t(shown)), codes, x, color,
                      nearest, farthest, alpha);
  }
}

void keep_any_row(const std::uint32_t* texels, const std::uint16_t* codes, int width, int stride,
                  bool first, std::uint32_t* color, BandColumns& columns) {
  if (first)
    keep<true>(texels, codes, width, stride, color, columns);
  else
    keep<false>(texels, codes, width, stride, color, columns);
}

void keep_row_of_cells(const BandColumns& columns, std::size_t cells, std::uint32_t steps,
                       std::uint16_t* nearest, std::uint8_t* opaque) {
  constexpr std::size_t kCell = SoftwareNailboard::kCell;
  const hn::CappedTag<std::uint16_t, kCell> d;
  const auto beyond = hn::Set(d, std::uint16_t(steps + 1)), all = hn::Set(d, 255);
  for (std::size_t i = 0; i < cells; ++i) {
    auto least = hn::Set(d, 0xffff);
    bool has_all = true;
    for (std::size_t x = i * kCell; x < (i + 1) * kCell; x += hn::Lanes(d)) {
      least = hn::Min(least, hn::LoadU(d, columns.nearest.data() + x));
      const auto has_code = hn::Lt(hn::LoadU(d, columns.farthest.data() + x), beyond);
      const auto covers = hn::Eq(hn::LoadU(d, columns.alpha.data() + x), all);
      has_all = has_all && hn::AllTrue(d, hn::And(has_code, covers));
    }
    nearest[i] = hn::GetLane(hn::MinOfLanes(d, least));
    opaque[i] = has_all;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(keep_any_row);
HWY_EXPORT(keep_row_of_cells);

void keep_row(const std::uint32_t* texels, const std::uint16_t* codes, int width, int stride,
              bool first, std::uint32_t* color, std::uint32_t* pairs, BandColumns& columns) {
  RILIEVO_EXPECTS(1 <= width && width <= stride && stride % 16 == 0);
  for (auto* of : {&columns.nearest, &columns.farthest, &columns.alpha})
    if (of->size() < std::size_t(stride)) of->resize(std::size_t(stride));
  std::memcpy(pairs, codes, std::size_t(stride) * sizeof *codes);
  HWY_DYNAMIC_DISPATCH(keep_any_row)(texels, codes, width, stride, first, color, columns);
}

void keep_cells(const BandColumns& columns, std::size_t cells, std::uint32_t steps,
                std::uint16_t* nearest, std::uint8_t* opaque) {
  RILIEVO_EXPECTS(columns.nearest.size() >= cells * SoftwareNailboard::kCell);
  HWY_DYNAMIC_DISPATCH(keep_row_of_cells)(columns, cells, steps, nearest, opaque);
}

}  // namespace rilievo
#endif

#include "rilievo/nailboard/gap_passes.h"

#include <algorithm>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/nailboard/gap_passes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using B = hn::CappedTag<std::uint8_t, 64>;
using VB = hn::Vec<B>;

using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;

// The nearest and the farthest surface of some texels, in order; kNoDepth twice where there is
// none.
HWY_INLINE void load_ends(const float* nearest, const float* farthest, VF& near, VF& far) {
  const F f;
  const VF a = hn::LoadU(f, nearest), b = hn::LoadU(f, farthest), none = hn::Set(f, kNoDepth);
  near = hn::Min(a, b), far = hn::Max(a, b);
  far = hn::IfThenElse(hn::Eq(far, none), near, far);
}

void find_ends(const float* nearest, const float* farthest, std::size_t count, float* least,
               float* most) {
  const F f;
  VF low = hn::Set(f, kNoDepth), high = hn::Zero(f);
  for (std::size_t x = 0; x < count; x += hn::Lanes(f)) {
    VF near, far;
    load_ends(nearest + x, farthest + x, near, far);
    low = hn::Min(low, near);
    high = hn::Max(high, hn::IfThenElseZero(hn::Lt(far, hn::Set(f, kNoDepth)), far));
  }
  *least = std::min(*least, hn::GetLane(hn::MinOfLanes(f, low)));
  *most = std::max(*most, hn::GetLane(hn::MaxOfLanes(f, high)));
}

void encode(const float* nearest, const float* farthest, std::size_t count, float back, float per_w,
            float slack, std::uint8_t* near_codes, std::uint8_t* far_codes) {
  const F f;
  const hn::RebindToSigned<F> i;
  const hn::Rebind<std::uint8_t, F> u8;
  const VF one = hn::Set(f, 1.0f), steps = hn::Set(f, float(kGapSteps));
  for (std::size_t x = 0; x < count; x += hn::Lanes(f)) {
    VF near, far;
    load_ends(nearest + x, farthest + x, near, far);
    const auto shown = hn::Lt(near, hn::Set(f, kNoDepth));
    const auto code = [&](VF depth) {
      return hn::Mul(hn::Sub(hn::Div(one, depth), hn::Set(f, back)), hn::Set(f, per_w));
    };
    const auto clamped = [&](VF v) {
      return hn::Add(one, hn::Min(hn::Max(v, hn::Zero(f)), steps));
    };
    const VF front = clamped(hn::Ceil(hn::Add(code(near), hn::Set(f, slack))));
    const VF behind = clamped(hn::Floor(hn::Sub(code(far), hn::Set(f, slack))));
    const VF none = hn::Set(f, 255.0f);
    hn::StoreU(hn::DemoteTo(u8, hn::ConvertTo(i, hn::IfThenElseZero(shown, front))), u8,
               near_codes + x);
    hn::StoreU(hn::DemoteTo(u8, hn::ConvertTo(i, hn::IfThenElse(shown, behind, none))), u8,
               far_codes + x);
  }
}

// Cell (x, y) lies between the texels x, x + 1 and y, y + 1.
void strips(const GapPlanes& planes, bool minus_x, bool minus_y, const GapStepCosts& costs,
            std::uint8_t* rows, std::uint8_t* widest) {
  const B d;
  const int lanes = int(hn::Lanes(d));
  const std::ptrdiff_t pitch = planes.pitch();
  const std::ptrdiff_t sx = minus_x ? -1 : 1;
  const std::ptrdiff_t behind = minus_x ? 1 : 0;  // which texel of a cell lies behind
  VB best[kGapLevels], straight[kGapLevels], diagonal[kGapLevels];
  for (std::size_t level = 0; level < kGapLevels; ++level) {
    best[level] = hn::Zero(d);
    straight[level] = hn::Set(d, costs.straight[level]);
    diagonal[level] = hn::Set(d, costs.diagonal[level]);
  }
  const VB one = hn::Set(d, std::uint8_t(1));
  const auto least3 = [&](const std::uint8_t* p) {
    return hn::Min(hn::LoadU(d, p), hn::Min(hn::LoadU(d, p - 1), hn::LoadU(d, p + 1)));
  };
  for (int i = 0; i <= planes.height(); ++i) {
    const int y = minus_y ? planes.height() - 1 - i : i - 1;
    const std::uint8_t* near = planes.near_row(y);
    const std::uint8_t* far = planes.far_row(y + (minus_y ? 1 : 0)) + behind;
    std::uint8_t* from = rows + (i & 1) * kGapLevels * pitch + GapPlanes::kLeft;
    std::uint8_t* to = rows + (1 - (i & 1)) * kGapLevels * pitch + GapPlanes::kLeft;
    for (std::ptrdiff_t x = -1; x < planes.width(); x += lanes) {
      const std::uint8_t* n = near + x;
      const VB a = hn::LoadU(d, n), b = hn::LoadU(d, n + 1);
      const VB e = hn::LoadU(d, n + pitch), f = hn::LoadU(d, n + pitch + 1);
      const VB front = hn::Max(hn::Max(a, b), hn::Max(e, f));
      const VB beyond = hn::Min(hn::Min(a, b), hn::Min(e, f));
      // Codes of the nearest are rounded up: one more.
      const VB jump = hn::SaturatedAdd(hn::SaturatedSub(front, beyond), one);
      const VB torn =
          hn::IfThenElse(hn::Eq(beyond, hn::Zero(d)), hn::Set(d, std::uint8_t(255)), jump);
      const VB least =
          hn::Min(least3(far + x), hn::Min(least3(far + x - pitch), least3(far + x + pitch)));
      for (std::size_t level = 0; level < kGapLevels; ++level) {
        const std::uint8_t* p = from + std::ptrdiff_t(level) * pitch + x;
        const VB hidden =
            hn::Min(least, hn::Min(hn::SaturatedAdd(hn::LoadU(d, p), straight[level]),
                                   hn::SaturatedAdd(hn::LoadU(d, p - sx), diagonal[level])));
        hn::StoreU(hidden, d, to + std::ptrdiff_t(level) * pitch + x);
        best[level] = hn::Max(best[level], hn::Min(torn, hn::SaturatedSub(front, hidden)));
      }
    }
  }
  for (std::size_t level = 0; level < kGapLevels; ++level) {
    HWY_ALIGN std::uint8_t values[64];
    hn::StoreU(best[level], d, values);
    widest[level] = *std::max_element(values, values + lanes);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(find_ends);
HWY_EXPORT(encode);
HWY_EXPORT(strips);

namespace {

// A row of a plane, and kNoDepth up to a whole number of vectors.
class PaddedRows {
 public:
  explicit PaddedRows(int width)
      : width_(width),
        near_((std::size_t(width) + 15) / 16 * 16, kNoDepth),
        far_(near_.size(), kNoDepth) {}
  void load(const Image<float>& nearest, const Image<float>& farthest, int y) {
    std::copy_n(nearest.row(y).data(), width_, near_.data());
    std::copy_n(farthest.row(y).data(), width_, far_.data());
  }
  [[nodiscard]] const float* near() const { return near_.data(); }
  [[nodiscard]] const float* far() const { return far_.data(); }
  [[nodiscard]] std::size_t size() const { return near_.size(); }

 private:
  int width_;
  std::vector<float> near_, far_;
};

}  // namespace

GapEnds find_gap_ends(const Image<float>& nearest, const Image<float>& farthest) {
  GapEnds ends;
  PaddedRows rows(nearest.width());
  for (int y = 0; y < nearest.height(); ++y) {
    rows.load(nearest, farthest, y);
    HWY_DYNAMIC_DISPATCH(find_ends)(rows.near(), rows.far(), rows.size(), &ends.least, &ends.most);
  }
  return ends;
}

void GapPlanes::encode(const Image<float>& nearest, const Image<float>& farthest, float w_back,
                       float per_w, float slack) {
  RILIEVO_EXPECTS(nearest.width() == width_ && nearest.height() == height_);
  PaddedRows rows(width_);
  for (int y = 0; y < height_; ++y) {
    rows.load(nearest, farthest, y);
    HWY_DYNAMIC_DISPATCH(encode)
    (rows.near(), rows.far(), rows.size(), w_back, per_w, slack, &near_[at(0, y)], &far_[at(0, y)]);
  }
}

GapPlanes::GapPlanes(int width, int height)
    : width_(width),
      height_(height),
      near_(std::size_t(height + 2 * kRows) * std::size_t(pitch()), std::uint8_t(0)),
      far_(near_.size(), std::uint8_t(255)) {}

void GapPlanes::transpose() {
  other_.clear();
  GapPlanes& to = other_.emplace_back(height_, width_);
  constexpr int kBlock = 32;  // of both planes, in the first cache
  for (int by = 0; by < height_; by += kBlock)
    for (int bx = 0; bx < width_; bx += kBlock)
      for (int y = by; y < std::min(height_, by + kBlock); ++y)
        for (int x = bx; x < std::min(width_, bx + kBlock); ++x)
          to.near_[to.at(y, x)] = near_[at(x, y)], to.far_[to.at(y, x)] = far_[at(x, y)];
}

std::array<std::uint8_t, kGapLevels> widest_strips(const GapPlanes& planes, bool minus_x,
                                                   bool minus_y, const GapStepCosts& costs) {
  // Two rows of each level: the cells done last, and those being done.
  static thread_local std::vector<std::uint8_t> rows;
  rows.assign(std::size_t(2 * kGapLevels) * std::size_t(planes.pitch()), std::uint8_t(255));
  std::array<std::uint8_t, kGapLevels> widest{};
  HWY_DYNAMIC_DISPATCH(strips)(planes, minus_x, minus_y, costs, rows.data(), widest.data());
  return widest;
}

}  // namespace rilievo
#endif

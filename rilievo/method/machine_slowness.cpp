#include "rilievo/method/machine_slowness.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/method/auto_decision.h"

namespace rilievo {
namespace {

// Of the logarithms of what polygons and the cache take over their counts, on a machine of slowness
// 1: mean and standard deviation of twelve walks.
constexpr double kUsual[] = {-0.4, 0.25}, kDeviation[] = {0.3, 0.5};
// The standard deviation of machines.
constexpr double kOfMachines = 0.7;
// The share of a frame.
constexpr double kNewest = 0.05;
// By how much the machine at its best is taken to be slower with each frame that does not say
// otherwise; and what is forgotten of the rest by a frame that says nothing.
constexpr double kCalmGrows = 0.002, kForgotten = 0.005;

}  // namespace

double MachineSlowness::estimate() const {
  double sum = 0, weights = 1 / (kOfMachines * kOfMachines);
  for (std::size_t i = 0; i < of_.size(); ++i) {
    if (of_[i].frames == 0) continue;
    const double weight = 1 / (kDeviation[i] * kDeviation[i]);
    sum += weight * (of_[i].mean - changed_ - kUsual[i]);
    weights += weight;
  }
  return std::clamp(std::exp(changed_ + sum / weights), kFastest, kSlowest);
}

double MachineSlowness::add(Source source, double times, bool at_most) {
  RILIEVO_EXPECTS(times > 0);
  Of& of = of_[std::size_t(source)];
  const double said = std::log(times), before = value_,
               expected = of.frames > 0 ? of.mean : std::log(value_) + kUsual[source];
  if (at_most && said > expected) return 1;
  const bool any_usual = std::ranges::any_of(of_, [](const Of& one) { return one.frames > kFew; });
  const double step = (said - of.mean) * newest_share(kNewest, ++of.frames);
  if (of.frames > kFew) {
    value_ = std::clamp(before * std::exp(step), kFastest, kSlowest);
    shift(std::log(value_ / before));
    calm_ = std::min((1 + kCalmGrows) * calm_, value_);
    return 1;
  }
  of.mean += step;
  value_ = estimate();
  calm_ = any_usual ? calm_ * value_ / before : value_;
  return value_ / before;
}

// The machine has become slower by that, so that all would take as much more.
void MachineSlowness::shift(double by) {
  for (Of& of : of_) of.mean += by;
  changed_ += by;
}

void MachineSlowness::forget() {
  if (value_ <= calm_) return;
  const double less = value_ + (calm_ - value_) * kForgotten;
  shift(std::log(less / value_));
  value_ = less;
}

}  // namespace rilievo

#include "rilievo/measure/stats.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

double percentile_of_sorted(std::span<const double> sorted, double share) {
  const double rank = share * double(sorted.size() - 1);
  const std::size_t below = std::min(std::size_t(rank), sorted.size() - 1);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double t = rank - double(below);
  // Equal neighbours may be infinite: no arithmetic on them.
  if (sorted[below] == sorted[above]) return sorted[below];
  return sorted[below] * (1 - t) + sorted[above] * t;
}

}  // namespace

double percentile(std::span<const double> values, double share) {
  RILIEVO_EXPECTS(!values.empty() && 0 <= share && share <= 1);
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return percentile_of_sorted(sorted, share);
}

Summary summarize(std::span<const double> values) {
  RILIEVO_EXPECTS(!values.empty());
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  double sum = 0;
  for (double v : sorted) sum += v;
  return {sum / double(sorted.size()), sorted.front(), sorted.back(),
          percentile_of_sorted(sorted, 0.5), percentile_of_sorted(sorted, 0.99)};
}

void Histogram::add(float value) {
  RILIEVO_EXPECTS_GE(value, 0.0f);
  // + 0 makes of -0 a 0.
  ++bins_[std::bit_cast<std::uint32_t>(value + 0.0f) >> kShift];
  ++count_;
}

void Histogram::add(const Histogram& other) {
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += other.bins_[i];
  count_ += other.count_;
}

double Histogram::percentile(double share) const {
  RILIEVO_EXPECTS(0 <= share && share <= 1);
  if (count_ == 0) return 0;
  const auto wanted = std::max<std::uint64_t>(1, std::uint64_t(std::ceil(share * double(count_))));
  std::uint64_t below = 0;
  std::size_t bin = 0;
  while ((below += bins_[bin]) < wanted) ++bin;
  // The first bin holds 0 and what is less than 1e-38; the last one infinity.
  if (bin == 0) return 0;
  const float low = std::bit_cast<float>(std::uint32_t(bin) << kShift);
  return std::isinf(low) ? low : std::bit_cast<float>(std::uint32_t(bin + 1) << kShift);
}

}  // namespace rilievo

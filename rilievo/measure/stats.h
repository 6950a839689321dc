// Mean and percentiles of many values.
//
// Percentiles interpolate linearly between the two nearest ranks, as numpy's default. Pure; any
// thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace rilievo {

// Mean, range and percentiles.
struct Summary {
  double mean = 0, min = 0, max = 0, p50 = 0, p99 = 0;
};

// The value below which `share` of the values lie, 0 <= share <= 1. Requires at least one value.
[[nodiscard]] double percentile(std::span<const double> values, double share);
// The median; of no values, 0.
[[nodiscard]] inline double median_of(std::span<const double> values) {
  return values.empty() ? 0 : percentile(values, 0.5);
}
// Mean, range and percentiles of `values`. Requires at least one value.
[[nodiscard]] Summary summarize(std::span<const double> values);

// Percentiles of more values than fit in memory: any number of values >= 0 in 128 KiB, each with a
// relative error of at most 1/64. The result does not depend on their order.
class Histogram {
 public:
  // Requires value >= 0; infinity is allowed.
  void add(float value);
  void add(const Histogram& other);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  // The smallest value that at least `share` of the values do not exceed, rounded up by at most one
  // part in 64; 0 if the histogram is empty.
  [[nodiscard]] double percentile(double share) const;

 private:
  // A bin is the sign, the exponent and the first 6 bits of the mantissa of a float.
  static constexpr int kShift = 23 - 6;
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(std::size_t(1) << (31 - kShift));
  std::uint64_t count_ = 0;
};

}  // namespace rilievo

// What do many figures come to?
//
// Percentiles as numpy's default has them: linear between the two nearest ranks. Pure; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace rilievo {

struct Summary {
  double mean = 0, min = 0, max = 0, p50 = 0, p99 = 0;
};

// `share` from 0 to 1. Requires at least one value.
[[nodiscard]] double percentile(std::span<const double> values, double share);
// Requires at least one value.
[[nodiscard]] Summary summarize(std::span<const double> values);

// Percentiles of more figures than one would keep: hundreds of millions of them >= 0 in 128 KiB,
// each known to one part in 64. Independent of the order in which they come.
class Histogram {
 public:
  // Requires a number >= 0; infinity is a number here.
  void add(float value);
  void add(const Histogram& other);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  // The least value that at least `share` of the figures do not exceed, rounded up by at most one
  // part in 64; 0 if there are none.
  [[nodiscard]] double percentile(double share) const;

 private:
  // A bin is the sign, the exponent and the first 6 bits of the mantissa of a float.
  static constexpr int kShift = 23 - 6;
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(std::size_t(1) << (31 - kShift));
  std::uint64_t count_ = 0;
};

}  // namespace rilievo

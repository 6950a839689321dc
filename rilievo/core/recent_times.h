// The median of the last times of something that is done again and again: what one that was
// disturbed took does not count. Allocates nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace rilievo {

// The last kMost times.
template <int kMost>
class RecentTimes {
 public:
  void add(double ms) { last_[std::size_t(count_++ % kMost)] = ms; }
  // As if `count` had taken `ms` each, and nothing before.
  void set(double ms, int count) { last_.fill(ms), count_ = count; }
  void forget() { count_ = 0; }
  // How many were added, also those that are no longer among the last.
  [[nodiscard]] int count() const { return count_; }
  // Of an even number the larger one of the middle; 0: there was none.
  [[nodiscard]] double median() const {
    const int count = std::min(count_, kMost);
    if (count == 0) return 0;
    std::array<double, std::size_t(kMost)> sorted = last_;
    const auto middle = sorted.begin() + count / 2;
    std::nth_element(sorted.begin(), middle, sorted.begin() + count);
    return *middle;
  }

 private:
  std::array<double, std::size_t(kMost)> last_{};
  int count_ = 0;
};

}  // namespace rilievo

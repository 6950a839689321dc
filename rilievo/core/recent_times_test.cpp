#include "rilievo/core/recent_times.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

// By sorting all of them.
double sorted_median(std::vector<double> all, std::size_t most) {
  if (all.size() > most) all.erase(all.begin(), all.end() - std::ptrdiff_t(most));
  if (all.empty()) return 0;
  std::sort(all.begin(), all.end());
  return all[all.size() / 2];
}

TEST(RecentTimes, AreTheLastOnesInTheMedian) {
  RecentTimes<9> recent;
  std::vector<double> all;
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    if (random.below(40) == 0) recent.forget(), all.clear();
    if (random.below(40) == 0) recent.set(i, 1 + i % 12), all.assign(std::size_t(1 + i % 12), i);
    EXPECT_EQ(recent.median(), sorted_median(all, 9)) << i;
    EXPECT_EQ(recent.count(), int(all.size()));
    const double ms = random.below(1000);
    recent.add(ms), all.push_back(ms);
  }
}

}  // namespace
}  // namespace rilievo

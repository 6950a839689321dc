#include "bench/gap.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/core/sanitized_test_helpers.h"

namespace rilievo::bench {
namespace {

TEST(GapBenchmark, no_strip_is_wider_than_bound_and_half_of_the_bound_is_too_little) {
  // Of some 300 cases, one has hidden bars that the slab does not bound.
  const int cases = std::max(240, sanitized_cases(480));
  const GapStats stats = run_gap_benchmark({cases, 1, 1});
  EXPECT_EQ(stats.cases, cases);
  EXPECT_EQ(stats.violations, 0) << stats.worst_excess_px;
  EXPECT_GT(stats.seen, cases / 5);
  EXPECT_GE(stats.tightness_median, 1);
  EXPECT_LE(stats.tightness_median, 3);  // what the project promises
  // The slab of what the capture saw is no bound: hidden bars are not in it.
  EXPECT_GT(stats.slab_violations, 0);
  EXPECT_GT(run_gap_benchmark({cases, 1, 0.5}).violations, 0);
}

TEST(GapBenchmark, the_seed_decides) {
  const GapStats a = run_gap_benchmark({96, 1, 1}), b = run_gap_benchmark({96, 1, 1});
  EXPECT_EQ(a.tightness_median, b.tightness_median);
  EXPECT_NE(a.tightness_median, run_gap_benchmark({96, 2, 1}).tightness_median);
}

}  // namespace
}  // namespace rilievo::bench

#include "bench/bound.h"

#include <gtest/gtest.h>

#include "rilievo/core/sanitized_test_helpers.h"

namespace rilievo::bench {
namespace {

TEST(BoundBenchmark, the_bound_holds_on_every_object_and_half_of_it_does_not) {
  const int cases = sanitized_cases(10000);
  const BoundStats stats = run_bound_benchmark({cases, 7, 1});
  EXPECT_EQ(stats.cases, cases);
  EXPECT_EQ(stats.violations, 0);
  EXPECT_GE(stats.objects.size(), 6u);
  EXPECT_GE(stats.tightness_median, 1);
  EXPECT_LE(stats.tightness_median, 3);  // what the project promises
  for (const BoundStats::OfObject& object : stats.objects) {
    EXPECT_GT(object.cases, cases / 10) << object.name;
    EXPECT_LE(object.tightness_median, 3) << object.name;
  }
  const BoundStats half = run_bound_benchmark({2000, 7, 0.5});
  for (const BoundStats::OfObject& object : half.objects)
    EXPECT_GT(object.violations, 0) << object.name;
}

TEST(BoundBenchmark, the_seed_decides) {
  const BoundStats a = run_bound_benchmark({800, 1, 1}), b = run_bound_benchmark({800, 1, 1});
  EXPECT_EQ(a.tightness_median, b.tightness_median);
  EXPECT_NE(a.tightness_median, run_bound_benchmark({800, 2, 1}).tightness_median);
}

}  // namespace
}  // namespace rilievo::bench

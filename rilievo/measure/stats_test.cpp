#include "rilievo/measure/stats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "rilievo/measure/machine.h"

namespace rilievo {
namespace {

TEST(Stats, percentiles_are_numpys) {
  // numpy.percentile([3, 1, 4, 1, 5, 9, 2, 6], [0, 25, 50, 99, 100])
  const double values[] = {3, 1, 4, 1, 5, 9, 2, 6};
  EXPECT_DOUBLE_EQ(percentile(values, 0), 1);
  EXPECT_DOUBLE_EQ(percentile(values, 0.25), 1.75);
  EXPECT_DOUBLE_EQ(percentile(values, 0.5), 3.5);
  EXPECT_NEAR(percentile(values, 0.99), 8.79, 1e-12);
  EXPECT_DOUBLE_EQ(percentile(values, 1), 9);
  const double one[] = {7};
  EXPECT_DOUBLE_EQ(percentile(one, 0.99), 7);
}

TEST(Stats, a_summary_is_its_parts) {
  std::mt19937 rng(1);
  std::vector<double> values(101);
  for (double& v : values) v = double(rng() % 1000);
  const Summary s = summarize(values);
  EXPECT_EQ(s.min, *std::min_element(values.begin(), values.end()));
  EXPECT_EQ(s.max, *std::max_element(values.begin(), values.end()));
  EXPECT_EQ(s.p50, percentile(values, 0.5));
  EXPECT_EQ(s.p99, percentile(values, 0.99));
  double sum = 0;
  for (double v : values) sum += v;
  EXPECT_DOUBLE_EQ(s.mean, sum / 101);
}

TEST(Stats, infinities_do_not_become_nan) {
  const double inf = std::numeric_limits<double>::infinity();
  const double values[] = {inf, inf, inf};
  EXPECT_EQ(summarize(values).p99, inf);
  EXPECT_EQ(summarize(values).mean, inf);
}

TEST(Histogram, percentiles_are_at_most_one_part_in_64_above_the_sorted_figures) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> exponent(-30, 8);
  for (int round = 0; round < 50; ++round) {
    Histogram all, first, second;
    std::vector<float> values(1 + rng() % 500);
    for (float& v : values) {
      v = rng() % 6 == 0 ? 0.0f : std::exp2(exponent(rng));
      all.add(v);
      (rng() % 2 ? first : second).add(v);
    }
    std::sort(values.begin(), values.end());
    first.add(second);
    EXPECT_EQ(first.count(), values.size());
    for (double share : {0.0, 0.01, 0.5, 0.9, 0.99, 1.0}) {
      // Nearest rank: the least value that `share` of all do not exceed.
      const auto rank = std::size_t(std::max(1.0, std::ceil(share * double(values.size()))));
      const double exact = values[rank - 1];
      EXPECT_GE(all.percentile(share), exact);
      EXPECT_LE(all.percentile(share), exact * (1 + 1.0 / 64));
      EXPECT_EQ(first.percentile(share), all.percentile(share));
    }
  }
}

TEST(Histogram, knows_nothing_zero_and_infinity) {
  Histogram h;
  EXPECT_EQ(h.percentile(0.5), 0);
  h.add(-0.0f);
  EXPECT_EQ(h.percentile(1), 0);
  h.add(std::numeric_limits<float>::infinity());
  EXPECT_EQ(h.percentile(0.5), 0);
  EXPECT_EQ(h.percentile(1), std::numeric_limits<double>::infinity());
}

TEST(Machine, has_a_processor_and_at_least_one_thread) {
  const Machine m = this_machine();
  EXPECT_FALSE(m.cpu.empty());
  EXPECT_GE(m.threads, 1);
  EXPECT_TRUE(m.gl_renderer.empty());
}

}  // namespace
}  // namespace rilievo

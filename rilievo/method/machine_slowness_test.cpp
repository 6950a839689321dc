#include "rilievo/method/machine_slowness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

using Source = MachineSlowness::Source;

// What polygons and the cache took over what was counted, beside a machine of about 1.1: twelve
// walks of bench/results/auto.md.
constexpr double kWalks[][2] = {{0.70, 1.75}, {0.99, 2.5},  {0.69, 1.9},  {1.30, 1.95},
                                {0.62, 1.05}, {0.68, 2.0},  {1.01, 2.0},  {0.75, 1.5},
                                {0.61, 0.58}, {0.52, 1.30}, {1.03, 1.65}, {0.45, 0.52}};

double density(double x, double mean, double deviation) {
  return std::exp(-0.5 * std::pow((x - mean) / deviation, 2));
}

// The mean of the posterior, by its integral.
double slow_twin(const double* polygons, const double* cache) {
  double sum = 0, weights = 0;
  for (double s = -5; s <= 5; s += 1e-3) {
    double weight = density(s, 0, 0.7);
    if (polygons) weight *= density(std::log(*polygons), s - 0.4, 0.3);
    if (cache) weight *= density(std::log(*cache), s + 0.25, 0.5);
    sum += weight * s, weights += weight;
  }
  return std::exp(sum / weights);
}

TEST(MachineSlowness, is_the_mean_of_the_posterior) {
  std::mt19937 rng(1);
  std::lognormal_distribution<double> any(0, 0.3);
  for (int i = 0; i < 200; ++i) {
    const double polygons = any(rng), cache = any(rng) * 1.5;
    MachineSlowness slowness;
    slowness.add(Source::polygons, polygons);
    EXPECT_NEAR(slowness.value(), slow_twin(&polygons, nullptr), 1e-3);
    const double before = slowness.value(), more = slowness.add(Source::cache, cache);
    EXPECT_NEAR(slowness.value(), slow_twin(&polygons, &cache), 1e-3);
    EXPECT_NEAR(more, slowness.value() / before, 1e-12);
  }
}

// Along the walks of one machine both say more than either, and more than frames of the cache at
// their word, which made it 0.5 to 2.5 times as slow as another.
TEST(MachineSlowness, two_sources_are_nearer_than_one) {
  double of_both = 0, of_cache = 0, at_their_word = 0;
  for (const auto& [polygons, cache] : kWalks) {
    MachineSlowness both, one;
    both.add(Source::polygons, polygons);
    both.add(Source::cache, cache), one.add(Source::cache, cache);
    of_both += std::pow(std::log(both.value() / 1.1), 2);
    of_cache += std::pow(std::log(one.value() / 1.1), 2);
    at_their_word += std::pow(std::log(cache / 1.1), 2);
  }
  EXPECT_LT(of_both, of_cache);
  EXPECT_LT(of_both, 0.3 * at_their_word);
  EXPECT_LT(std::sqrt(of_both / std::size(kWalks)), std::log(1.35));
}

TEST(MachineSlowness, what_changes_later_is_the_machine_whoever_draws) {
  for (const Source other : {Source::polygons, Source::cache}) {
    MachineSlowness slowness;
    for (int i = 0; i < 40; ++i)
      slowness.add(Source::polygons, 0.7), slowness.add(Source::cache, 2);
    const double calm = slowness.value();
    // Twice as slow; some hundred frames say so.
    for (int i = 0; i < 200; ++i)
      EXPECT_EQ(slowness.add(other, other == Source::cache ? 4 : 1.4), 1);
    EXPECT_NEAR(slowness.value() / calm, 2, 0.01);
    // The other one says the same, and changes nothing.
    const bool cache_next = other == Source::polygons;
    slowness.add(cache_next ? Source::cache : Source::polygons, cache_next ? 4 : 1.4);
    EXPECT_NEAR(slowness.value() / calm, 2, 0.01);
  }
}

TEST(MachineSlowness, frames_that_capture_say_only_that_it_is_faster) {
  MachineSlowness slowness;
  for (const double times : {20.0, 3.0}) {
    EXPECT_EQ(slowness.add(Source::cache, times, true), 1);
    EXPECT_EQ(slowness.value(), 1);
  }
  EXPECT_LT(slowness.add(Source::cache, 0.5, true), 1);
  EXPECT_LT(slowness.value(), 1);
  const double before = slowness.value();
  EXPECT_EQ(slowness.add(Source::cache, 0.7, true), 1);
  EXPECT_EQ(slowness.value(), before);
}

TEST(MachineSlowness, other_programs_are_forgotten_while_nothing_is_said) {
  MachineSlowness slowness;
  for (int i = 0; i < 40; ++i) slowness.add(Source::cache, 2);
  const double calm = slowness.value();
  for (int i = 0; i < 12; ++i) slowness.add(Source::cache, 6);
  EXPECT_GT(slowness.value(), 1.3 * calm);
  for (int i = 0; i < 1000; ++i) slowness.forget();
  EXPECT_NEAR(slowness.value() / calm, 1, 0.05);
  EXPECT_NEAR(slowness.add(Source::cache, 2) * slowness.value() / calm, 1, 0.05);
}

TEST(MachineSlowness, stays_within_its_limits) {
  MachineSlowness slowness;
  for (int i = 0; i < 100; ++i) slowness.add(Source::polygons, 1e-6);
  EXPECT_EQ(slowness.value(), MachineSlowness::kFastest);
  for (int i = 0; i < 1000; ++i) slowness.add(Source::polygons, 1e6);
  EXPECT_EQ(slowness.value(), MachineSlowness::kSlowest);
}

// A look at the sky, or at what is hidden behind a wall, says nothing for ever.
TEST(MachineSlowness, comes_back_from_its_limits) {
  for (const double extreme : {0.02, 50.0}) {
    MachineSlowness slowness;
    for (int i = 0; i < 40; ++i) slowness.add(Source::polygons, 1);
    const double usual = slowness.value();
    for (int i = 0; i < 200; ++i) slowness.add(Source::polygons, extreme);
    EXPECT_EQ(slowness.value(),
              extreme < 1 ? MachineSlowness::kFastest : MachineSlowness::kSlowest);
    for (int i = 0; i < 300; ++i) slowness.add(Source::polygons, 1);
    EXPECT_NEAR(slowness.value() / usual, 1, 0.01) << extreme;
  }
}

// In a busy moment another one draws for the first time: what is calm is as calm as before.
TEST(MachineSlowness, a_second_source_in_a_busy_moment_is_forgotten_too) {
  MachineSlowness slowness;
  for (int i = 0; i < 40; ++i) slowness.add(Source::cache, 2);
  const double calm = slowness.value();
  for (int i = 0; i < 12; ++i) slowness.add(Source::cache, 6);
  const double busy = slowness.value();
  const double more = slowness.add(Source::polygons, 2.1);
  EXPECT_NEAR(slowness.value(), busy * more, 1e-12);
  for (int i = 0; i < 2000; ++i) slowness.forget();
  EXPECT_NEAR(slowness.value() / (calm * more), 1, 0.05);
}

// Four times as slow as it was: a source that says just that changes nothing.
TEST(MachineSlowness, what_agrees_with_a_machine_that_has_changed_changes_nothing) {
  MachineSlowness slowness;
  for (int i = 0; i < 40; ++i) slowness.add(Source::polygons, std::exp(-0.4));
  EXPECT_NEAR(slowness.value(), 1, 1e-12);
  for (int i = 0; i < 300; ++i) slowness.add(Source::polygons, 4 * std::exp(-0.4));
  EXPECT_NEAR(slowness.value(), 4, 0.01);
  EXPECT_NEAR(slowness.add(Source::cache, 4 * std::exp(0.25)), 1, 0.01);
}

}  // namespace
}  // namespace rilievo

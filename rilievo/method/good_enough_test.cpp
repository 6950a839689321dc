#include "rilievo/method/good_enough.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

TEST(GoodEnough, frames_may_lose_what_is_allowed_or_what_the_cache_loses) {
  EXPECT_TRUE(good_enough(4, std::nullopt, 4));
  EXPECT_FALSE(good_enough(4.1, std::nullopt, 4));
  // A good cache allows no less, a bad one more.
  EXPECT_TRUE(good_enough(4, 1, 4));
  EXPECT_FALSE(good_enough(4.1, 1, 4));
  EXPECT_TRUE(good_enough(7, 7, 4));
  EXPECT_FALSE(good_enough(7.6, 7, 4));
  // Not worse than that, however bad the cache is.
  EXPECT_TRUE(good_enough(8, 12, 4));
  EXPECT_FALSE(good_enough(8.1, 12, 4));
}

// Frames whose values are the truth's with noise: what is measured beside a noisy truth.
TEST(GoodEnough, the_noise_of_the_measured_truth_is_left_out) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  for (const double off : {0.5, 1.0, 2.0, 4.0}) {
    double measured = 0, measured_direct = 0, all = 0, all_direct = 0;
    for (int pixel = 0; pixel < 100000; ++pixel) {
      double truth = 0, direct = 0;
      for (int i = 0; i < 16; ++i) truth += noise(random) / 16;
      for (int i = 0; i < 4; ++i) direct += noise(random) / 4;
      const double shown = off * noise(random) / 2;
      const auto square = [](double x) { return x * x; };
      measured += square(shown - truth), measured_direct += square(direct - truth);
      all += square(shown), all_direct += square(direct);
    }
    EXPECT_NEAR(without_own_noise(10 * std::log10(measured / measured_direct)),
                10 * std::log10(all / all_direct), 0.1)
        << off;
  }
  EXPECT_NEAR(without_own_noise(0), 0, 1e-9);
  EXPECT_LT(without_own_noise(-20), -5);
}

}  // namespace
}  // namespace rilievo

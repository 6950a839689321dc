#include "bench/nailboard_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rilievo::bench {
namespace {

TEST(nailboard_error, turning_about_the_eye_leaves_rounding_errors_only) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const EyeMotion motion{0, 0, 60 * unit(random) - 30};
    // Window depths carry 1e-16; eye distances up to d / n times as much, in percent.
    EXPECT_LT(depth_error_percent(motion, 10 + 140 * unit(random), {unit(random), unit(random)},
                                  unit(random)),
              1e-11);
  }
}

// With the moved eye N before the near plane and F before the far one: 1 / z = (1 - Delta) / N +
// Delta / F, where the truth is z = 2 D / (2 - Delta) - t for an object at D ... 2 D.
TEST(nailboard_error, a_way_along_the_axis_follows_the_closed_form) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 1000; ++i) {
    const double way = 0.6 * unit(random) - 0.3, delta = unit(random), d = 10 + 140 * unit(random);
    const double distance = d / (1 - way), moved = way * distance;
    const double near = distance - moved, far = 2 * distance - moved;
    const double linear = 1 / ((1 - delta) / near + delta / far);
    const double exact = 2 * distance / (2 - delta) - moved;
    EXPECT_NEAR(depth_error_percent({way, 0, 0}, d, {unit(random), unit(random)}, delta),
                100 * std::abs(linear - exact) / exact, 1e-9);
  }
}

TEST(nailboard_error, a_way_across_the_axis_is_exact_until_the_eye_turns) {
  EXPECT_LT(max_depth_error_percent({0, 0.2, 0}, 10), 1e-11);
  EXPECT_GT(max_depth_error_percent({0, 0.2, 30}, 10), 1);
}

TEST(nailboard_error, the_largest_is_the_largest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  const EyeMotion motion{0.05, 0.02, 20};
  double largest = 0;
  for (int i = 0; i < 2000; ++i)
    largest = std::max(largest,
                       depth_error_percent(motion, 10, {unit(random), unit(random)}, unit(random)));
  // The grid has the corners of the picture, where the largest is, and steps of 0.01 in Delta.
  EXPECT_GE(max_depth_error_percent(motion, 10), 0.999 * largest);
}

}  // namespace
}  // namespace rilievo::bench

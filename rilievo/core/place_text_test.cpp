#include "rilievo/core/place_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

namespace rilievo {
namespace {

TEST(PlaceText, has_as_many_digits_as_the_size_asks_for) {
  EXPECT_EQ(place_text({1.5, -2, 0}, 3), "1.5 -2 0");
  EXPECT_EQ(place_text({470012.3456, 412.25, -5.4e6}, 8), "470012.346 412.25 -5400000");
  EXPECT_EQ(place_text({470012.3456, 1e9, 0}, 3e6), "4.7e+05 1000000000 0");
  EXPECT_EQ(place_text({12345.678, 0, 0}, 0), "1.235e+04 0 0");
}

TEST(PlaceText, is_right_to_a_thousandth_of_the_size) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1), power(-4, 5);
  for (int i = 0; i < 2000; ++i) {
    const double size = std::pow(10.0, power(rng));
    const glm::dvec3 place = std::pow(10.0, power(rng) + 3) * glm::dvec3(u(rng), u(rng), u(rng));
    std::istringstream text(place_text(place, size));
    glm::dvec3 read(0);
    ASSERT_TRUE(text >> read.x >> read.y >> read.z);
    for (int c = 0; c < 3; ++c)
      // Nine decimals at most, and half the last digit of four.
      EXPECT_LE(std::abs(read[c] - place[c]), 1e-3 * size + 1e-9) << text.str();
  }
}

}  // namespace
}  // namespace rilievo

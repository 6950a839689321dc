#include "rilievo/layered_relief/sample_sides.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

// Lines of sight of which `of_line` tells how often each meets the object.
template <class OfLine>
bool is_closed(int lines, const OfLine& of_line) {
  LayeredDepthImage layers;
  layers.first = {0};
  for (int i = 0; i < lines; ++i) {
    for (int k = of_line(i); k > 0; --k) layers.samples.emplace_back().object = 1;
    layers.first.push_back(layers.samples.size());
  }
  const LayeredDepthImage* const all[] = {&layers};
  return find_closed_objects(all).contains(1);
}

// Leaves at random are met by a Poisson number of times: of many, hardly a line meets one alone.
TEST(SampleSides, many_leaves_are_not_a_closed_body) {
  for (const double mean : {1.0, 3.0, 5.0, 7.0, 10.0, 20.0}) {
    Random random(3);
    const auto leaves = [&](int) {
      int count = 0;
      for (double left = mean; (left += std::log(1 - double(random.unit()))) > 0;) ++count;
      return count;
    };
    EXPECT_FALSE(is_closed(20'000, leaves)) << mean;
  }
}

TEST(SampleSides, three_sheets_are_not_a_closed_body) {
  EXPECT_FALSE(is_closed(1000, [](int) { return 3; }));
  EXPECT_FALSE(is_closed(1000, [](int i) { return i == 500 ? 2 : 3; }));
}

// Where they touch, the two surfaces between them are one.
TEST(SampleSides, bodies_that_touch_are_closed) {
  EXPECT_TRUE(is_closed(1000, [](int i) { return i % 10 < 3 ? 3 : i % 10 < 5 ? 4 : 2; }));
}

}  // namespace
}  // namespace rilievo

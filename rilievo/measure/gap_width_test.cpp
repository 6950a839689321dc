#include "rilievo/measure/gap_width.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace rilievo {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

// The header's words: from each pixel, in each of eight directions, as far as it goes.
double slow_widest_gap(const IdImage& ids, const Image<float>& truth, const Image<float>& seen) {
  const auto lacks = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= ids.width() || y >= ids.height() || ids(x, y) == 0) return false;
    for (int j = y - 1; j <= y + 1; ++j)
      for (int i = x - 1; i <= x + 1; ++i)
        if (i >= 0 && j >= 0 && i < ids.width() && j < ids.height() && ids(i, j) == ids(x, y) &&
            !(seen(x, y) > 1.01f * truth(i, j)))
          return false;
    return true;
  };
  double widest = 0;
  for (int y = 0; y < ids.height(); ++y)
    for (int x = 0; x < ids.width(); ++x) {
      if (!lacks(x, y)) continue;
      double shortest = 1e9;
      for (const auto& [dx, dy] : {std::pair(1, 0), {0, 1}, {1, 1}, {1, -1}}) {
        int length = 1;
        for (int i = 1; lacks(x + i * dx, y + i * dy); ++i) ++length;
        for (int i = 1; lacks(x - i * dx, y - i * dy); ++i) ++length;
        shortest = std::min(shortest, length * std::hypot(dx, dy));
      }
      widest = std::max(widest, shortest);
    }
  return widest;
}

TEST(GapWidth, is_what_the_slow_definition_gives) {
  std::mt19937 rng(5);
  int with_gap = 0;
  for (int round = 0; round < 300; ++round) {
    const int w = 1 + int(rng() % 24), h = 1 + int(rng() % 24);
    IdImage ids(w, h);
    Image<float> truth(w, h, kNothing), seen(w, h, kNothing);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        ids(x, y) = std::uint32_t(x / 5 + y / 7) % 3;
        if (ids(x, y) != 0) truth(x, y) = 1 + 0.002f * float(rng() % 10) + float(ids(x, y));
        seen(x, y) = truth(x, y);
      }
    for (int k = 0; k < 3; ++k) {
      const int x0 = int(rng() % w), y0 = int(rng() % h), size = 1 + int(rng() % 9);
      for (int y = y0; y < std::min(h, y0 + size); ++y)
        for (int x = x0; x < std::min(w, x0 + size); ++x)
          seen(x, y) = rng() % 8 == 0 ? 0.5f : k == 0 ? kNothing : 1.02f * truth(x, y);
    }
    const double widest = widest_gap_px(ids, truth, seen);
    ASSERT_DOUBLE_EQ(widest, slow_widest_gap(ids, truth, seen));
    with_gap += widest > 0;
  }
  EXPECT_GT(with_gap, 200);
}

TEST(GapWidth, of_a_straight_strip_in_any_direction_is_its_width) {
  for (int degrees = 0; degrees < 180; degrees += 5)
    for (const double width : {3.0, 8.0, 15.0}) {
      const double a = degrees * std::numbers::pi / 180;
      IdImage ids(80, 80, 1);
      Image<float> truth(80, 80, 2.0f), seen = truth;
      for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 80; ++x)
          if (std::abs((x - 40) * std::cos(a) + (y - 40) * std::sin(a)) < width / 2)
            seen(x, y) = kNothing;
      const double found = widest_gap_px(ids, truth, seen);
      EXPECT_LE(found, 1.09 * width + std::numbers::sqrt2) << degrees;
      EXPECT_GE(found, width - std::numbers::sqrt2) << degrees;
    }
}

TEST(GapWidth, what_is_nearer_or_slanted_is_no_gap) {
  IdImage ids(20, 20, 1);
  Image<float> truth(20, 20), seen(20, 20);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 20; ++x) {
      truth(x, y) = 1 + 0.2f * float(x);
      seen(x, y) = 1 + 0.2f * float(x + 1);  // a pixel to the side
    }
  // The last column has no neighbour that is as far.
  for (int y = 0; y < 20; ++y) seen(19, y) = truth(19, y);
  EXPECT_EQ(widest_gap_px(ids, truth, seen), 0);
  for (float& z : seen.texels()) z = 0.5f;
  EXPECT_EQ(widest_gap_px(ids, truth, seen), 0);
  // The sky of the true frame lacks nothing.
  EXPECT_EQ(widest_gap_px(IdImage(20, 20), Image<float>(20, 20, kNothing),
                          Image<float>(20, 20, kNothing)),
            0);
}

}  // namespace
}  // namespace rilievo

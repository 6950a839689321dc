#include "rilievo/layered_relief/prewarp_strips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_relief/relief_test_helpers.h"

namespace rilievo {
namespace {

TEST(PrewarpStrips, are_as_many_as_threads_if_these_are_few_and_a_multiple_of_them_if_more) {
  EXPECT_EQ(strip_count({300, 600}, 1024, 1), 1);
  EXPECT_EQ(strip_count({300, 600}, 1024, 2), 2);
  EXPECT_EQ(strip_count({300, 600}, 1024, 3), 3);
  EXPECT_EQ(strip_count({300, 600}, 1024, 64), kStrips);
  // Not if they were low.
  EXPECT_EQ(strip_count({300, 100}, 1024, 2), 1);
  EXPECT_EQ(strip_count({300, 1}, 1024, 2), 1);
  // Four would be small enough, of which one of three threads had two.
  EXPECT_EQ(strip_count({2048, 2048}, 1024, 4), 4);
  EXPECT_EQ(strip_count({2048, 2048}, 1024, 3), 6);
  EXPECT_EQ(strip_count({2048, 2048}, 1024, 16), 4);
}

TEST(PrewarpStrips, have_equal_shares_of_the_work_to_a_row) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> unit(0, 1);
  int free = 0;
  for (int i = 0; i < sanitized_cases(200); ++i) {
    const int height = 100 + int(rng() % 900), count = 1 + int(rng() % 6);
    const int bands = 1 + int(rng() % 80);
    const Texels shown{{-7, 13}, {90, 13 + height}};
    std::vector<double> above{0};
    // A band in ten has most of it.
    for (int band = 0; band < bands; ++band)
      above.push_back(above.back() + (rng() % 10 ? 1 : 20) * (0.2 + unit(rng)));
    const int highest = most_strip_rows(height, count);
    const auto work_above = [&](int row) {
      const double at = double(row) / height * bands;
      const int band = std::min(int(at), bands - 1);
      return above[std::size_t(band)] +
             (at - band) * (above[std::size_t(band) + 1] - above[std::size_t(band)]);
    };
    std::vector<Texels> strips;
    divide_work(shown, above, count, strips);
    ASSERT_EQ(int(strips.size()), count);
    int from = shown.min.y;
    for (int k = 0; k < count; ++k) {
      const Texels& strip = strips[std::size_t(k)];
      EXPECT_EQ(strip.min, glm::ivec2(shown.min.x, from));
      EXPECT_EQ(strip.max.x, shown.max.x);
      EXPECT_GT(strip.max.y, strip.min.y);
      from = strip.max.y;
      EXPECT_LE(strip.size().y, highest);
      // The share lies within a row of where the strip ends, unless it or those after it were
      // higher than a strip may be.
      const int end = from - shown.min.y;
      if (strip.size().y == highest || height - end == highest * (count - k - 1)) continue;
      ++free;
      EXPECT_GE(above.back() * (k + 1) / count, work_above(end - 1) - 1e-9);
      EXPECT_LE(above.back() * (k + 1) / count, work_above(std::min(end + 1, height)) + 1e-9);
    }
    EXPECT_EQ(from, shown.max.y);
  }
  EXPECT_GT(free, sanitized_cases(200));
}

// All the work lies in the first rows, or in the last ones.
TEST(PrewarpStrips, fit_into_the_memory_of_a_thread_wherever_the_work_lies) {
  std::mt19937 rng(6);
  std::size_t largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const int max_size = 16 + int(rng() % 2000), most = 16 + int(rng() % 1100);
    const int padding = int(rng() % 9);
    const glm::ivec2 size{1 + int(rng() % unsigned(max_size)), 1 + int(rng() % unsigned(max_size))};
    std::vector<double> above(65, i % 2 ? 1.0 : 0.0);
    above.front() = 0, above.back() = 1;
    for (std::size_t k = 1; k + 1 < above.size(); ++k) above[k] += 1e-6 * double(k);
    above.back() += 1e-6 * double(above.size());
    std::vector<Texels> strips;
    divide_work({{0, 0}, size}, above, strip_count(size, most, 1 + int(rng() % 16)), strips);
    const std::size_t room = most_strip_texels(max_size, most, padding);
    for (const Texels& strip : strips) {
      const std::size_t texels = std::size_t(strip.size().y) * std::size_t(size.x + padding);
      EXPECT_LE(texels, room) << size.x << " " << size.y << " " << max_size << " " << most;
      largest = std::max(largest, 100 * texels / room);
    }
  }
  // In percent: no room is wasted.
  EXPECT_GT(largest, 90u);
}

TEST(PrewarpStrips, work_is_estimated_where_the_samples_land) {
  std::mt19937 rng(5);
  int eyes = 0, off_middle = 0;
  for (int i = 0; i < sanitized_cases(30); ++i) {
    LayeredRelief relief =
        *build_layered_relief(random_layers(rng, 97, 83, 0, i % 2 == 1), {.tile_size = 8});
    const auto warp = relief_warp(relief.frame(), random_eye(rng, relief));
    ASSERT_TRUE(warp);
    // Not from near, where the sides of a tile lie far apart.
    if (warp->least_d(2) > relief.first_d) continue;
    ++eyes;
    std::vector<double> rows;
    Texels shown{glm::ivec2(1 << 20), glm::ivec2(-(1 << 20))};
    const double resolution = 2;
    for (const PlacedSample& s : label_samples(relief)) {
      const glm::dvec2 at = resolution * warp->moved(s.u + 0.5, s.v + 0.5, relief.d(s.code));
      rows.push_back(at.y);
      shown = {glm::min(shown.min, glm::ivec2(glm::floor(at))),
               glm::max(shown.max, glm::ivec2(glm::floor(at)) + 1)};
    }
    std::vector<double> above(33);
    estimate_work(relief, *warp, resolution, 0, shown, above);
    const double height = shown.size().y, texels = height * shown.size().x / 6;
    for (std::size_t k = 0; k < above.size(); ++k) {
      const double share = double(k) / double(above.size() - 1);
      const double expected = double(std::count_if(rows.begin(), rows.end(), [&](double row) {
        return row < shown.min.y + share * height;
      }));
      // A tile's samples lie unevenly in it: of surfaces at different depths.
      EXPECT_NEAR(above[k] - share * texels, expected, 0.1 * double(rows.size())) << i << " " << k;
      if (2 * k + 1 == above.size())
        off_middle += std::abs(expected / double(rows.size()) - 0.5) > 0.1;
    }
  }
  // Equal heights would not do.
  EXPECT_GT(eyes, sanitized_cases(30) / 3);
  EXPECT_GT(off_middle, eyes / 5);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/measure/popping.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rilievo {
namespace {

Image<float> random_map(std::mt19937& rng, int w, int h) {
  std::uniform_real_distribution<float> u(0, 1);
  Image<float> map(w, h);
  for (float& value : map.texels()) value = u(rng);
  return map;
}

double mean(const Image<float>& map, int x0, int y0, int w, int h) {
  double sum = 0;
  for (int y = y0; y < y0 + h; ++y)
    for (int x = x0; x < x0 + w; ++x) sum += map(x, y);
  return sum / (double(w) * h);
}

TEST(Popping, is_the_largest_excess_of_any_tile) {
  std::mt19937 rng(1);
  for (const auto& [w, h] : {std::pair(200, 130), {64, 64}, {65, 63}, {10, 300}, {1, 1}}) {
    const Image<float> truth = random_map(rng, w, h), seen = random_map(rng, w, h);
    const int tw = std::min(w, kPopTile), th = std::min(h, kPopTile);
    double expected = 0;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        // Tiles begin at every 32nd pixel, the last ones at the edge.
        const bool begins_x = (x % 32 == 0 && x + tw <= w) || x + tw == w;
        const bool begins_y = (y % 32 == 0 && y + th <= h) || y + th == h;
        if (begins_x && begins_y)
          expected = std::max(expected, mean(seen, x, y, tw, th) - mean(truth, x, y, tw, th));
      }
    const Pop pop = largest_pop(truth, seen);
    // Sums of up to 26000 doubles below 1.
    EXPECT_NEAR(pop.tile, expected, 1e-9);
    EXPECT_NEAR(pop.frame, std::max(0.0, mean(seen, 0, 0, w, h) - mean(truth, 0, 0, w, h)), 1e-9);
  }
}

TEST(Popping, a_small_jump_shows_in_its_tile_and_hardly_in_the_frame) {
  const Image<float> truth(640, 384, 0.25f);
  Image<float> seen = truth;
  for (int y = 96; y < 160; ++y)
    for (int x = 320; x < 384; ++x) seen(x, y) = 0.75f;
  const Pop pop = largest_pop(truth, seen);
  EXPECT_NEAR(pop.tile, 0.5, 1e-9);
  EXPECT_NEAR(pop.frame, 0.5 / 60, 1e-9);
  // What changes less than the truth is no pop.
  EXPECT_EQ(largest_pop(seen, truth).tile, 0);
  EXPECT_EQ(largest_pop(seen, truth).frame, 0);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/layered_impostor/software/silhouette_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <random>

#include "rilievo/layered_impostor/software/sampled_pixels.h"

namespace rilievo {
namespace {

TEST(SilhouettePixels,
     are_those_with_what_is_shown_and_what_is_not_among_them_and_four_neighbours) {
  std::mt19937 rng(1);
  int along = 0;
  for (int round = 0; round < 40; ++round) {
    TileBits asked, shown;
    const unsigned one_in = 2 + unsigned(round) / 4;
    for (int y = -1; y <= 64; ++y)
      for (int x = -1; x <= 64; ++x) {
        if ((x < 0 || x > 63) && (y < 0 || y > 63)) continue;
        if (rng() % one_in == 0) continue;
        asked.set(x, y);
        if (rng() % one_in != 0) shown.set(x, y);
      }
    const TileBits found = silhouette_pixels(asked, shown);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        bool some = false, missing = false;
        const auto look = [&](int u, int v) {
          if (!asked.has(u, v)) return;
          some |= shown.has(u, v), missing |= !shown.has(u, v);
        };
        look(x, y), look(x - 1, y), look(x + 1, y), look(x, y - 1), look(x, y + 1);
        EXPECT_EQ(found.has(x, y), asked.has(x, y) && some && missing) << x << " " << y;
        along += found.has(x, y);
      }
  }
  EXPECT_GT(along, 10000);
}

// A wire along the border of two rows of pixels, whose centres show it in two columns alone.
TEST(SampledPixels, follow_what_is_thinner_than_a_pixel) {
  TileBits asked, shown;
  for (std::uint64_t& row : asked.row) row = ~std::uint64_t(0);
  shown.set(9, 20), shown.set(50, 21);
  const auto shows = [](const SampledPixels::Pixel& at, int s) {
    return std::abs(float(at.y) + FrameTile::kSampleY[s] - 21) < 0.4f;
  };
  const auto pixels = std::make_unique<SampledPixels>();
  pixels->clear();
  pixels->add({10, 20, 1, 2});
  int count = 0;
  while (const SampledPixels::Pixel* at = pixels->next()) {
    ++count;
    unsigned samples = 0;
    for (int s = 0; s < 4; ++s) samples |= unsigned(shows(*at, s)) << s;
    pixels->add_beside(*at, samples, asked, shown);
    EXPECT_EQ(at->begin, 1);
    EXPECT_EQ(at->end, 2);
  }
  for (int x = 0; x < 64; ++x)
    for (int y = 0; y < 64; ++y)
      EXPECT_EQ(pixels->has(x, y), (y == 20 || y == 21) && !shown.has(x, y)) << x << ' ' << y;
  EXPECT_EQ(count, 126);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/nailboard/encode_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/core/depth.h"

namespace rilievo {
namespace {

TEST(EncodePicture, keeps_depths_as_codes_and_sums_blocks_up) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<float> u(0, 1);
  int empty = 0, beside = 0;
  for (int round = 0; round < 30; ++round) {
    const int bits = 2 + round % 15;
    RasterPicture picture;
    picture.width = 1 + int(rng() % 50), picture.height = 1 + int(rng() % 50);
    for (int i = 0; i < picture.width * picture.height; ++i) {
      const int covered = round % 5 == 0 ? 4 : rng() % 5 < 4 ? 0 : 1 + int(rng() % 4);
      picture.color.push_back(glm::u8vec4(1, 2, 3, (255 * covered + 2) / 4));
      picture.depth.push_back(covered == 0      ? 1.0f
                              : rng() % 20 == 0 ? 0.0f
                                                : std::min(u(rng), 0.999999f));
    }
    AtlasPicture encoded;
    encode_picture(picture, bits, encoded);
    const int columns = blocks_across(picture.width), rows = blocks_across(picture.height);
    ASSERT_EQ(encoded.blocks.size(), std::size_t(columns * rows));
    const double steps = double(delta_steps(bits));
    std::vector<OcclusionTile> expected(encoded.blocks.size());
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto i = std::size_t(y * picture.width + x);
        const unsigned code = bits > 8 ? encoded.codes16[i] : encoded.codes8[i];
        float depth = picture.depth[i];
        if (picture.color[i].a == 0)
          for (int v = std::max(0, y - 1); v <= std::min(picture.height - 1, y + 1); ++v)
            for (int u = std::max(0, x - 1); u <= std::min(picture.width - 1, x + 1); ++u)
              depth = std::min(depth, picture.depth[std::size_t(v * picture.width + u)]);
        if (depth == 1.0f) {
          ++empty;
          ASSERT_EQ(code, unsigned(steps) + 1);
          continue;
        }
        beside += picture.color[i].a == 0;
        // The nearest code: half a code to either side, but for a float's 2^-24 of 65534.
        ASSERT_NEAR(code, depth * steps, 0.505) << bits;
        ASSERT_LE(code, unsigned(steps));
        OcclusionTile& block = expected[std::size_t(y / 4 * columns + x / 4)];
        block.covered = std::uint16_t(block.covered | 1u << (x % 4 + 4 * (y % 4)));
        if (picture.color[i].a == 255)
          block.opaque = std::uint16_t(block.opaque | 1u << (x % 4 + 4 * (y % 4)));
        const double delta = code / steps;
        // To whole steps, outwards; whole ones stay, though 1 / 254 is none in binary.
        block.nearest = std::min(block.nearest, std::uint8_t(std::floor(delta * 254 + 1e-9)));
        block.farthest = std::max(block.farthest, std::uint8_t(std::ceil(delta * 254 - 1e-9)));
      }
    EXPECT_EQ(encoded.blocks, expected) << bits << " bits";
  }
  EXPECT_GT(empty, 500);
  EXPECT_GT(beside, 5000);
}

}  // namespace
}  // namespace rilievo

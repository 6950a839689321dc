#include "rilievo/render/mask_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

// Green leaves, disks with soft edges, on magenta air.
Rgba8Image leaves(std::mt19937& rng, int width, int height, int count, float radius) {
  Rgba8Image image(width, height);
  std::uniform_real_distribution<float> u(0, 1);
  std::vector<glm::vec2> centers;
  for (int k = 0; k < count; ++k) {
    const float x = u(rng) * float(width);
    centers.emplace_back(x, u(rng) * float(height));
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float alpha = 0;
      for (const glm::vec2& c : centers)
        alpha = std::max(
            alpha, radius + 0.5f - glm::length(glm::vec2(float(x) + 0.5f, float(y) + 0.5f) - c));
      const auto byte = std::uint8_t(255.0f * std::clamp(alpha, 0.0f, 1.0f) + 0.5f);
      image(x, y) = byte > 0 ? glm::u8vec4(0, 200, 0, byte) : glm::u8vec4(255, 0, 255, 0);
    }
  return image;
}

Rgba8Image level_of(const MipChain& chain, std::size_t l) {
  const MipChain::Level& level = chain.levels[l];
  Rgba8Image image(level.width, level.height);
  std::copy_n(chain.texels.begin() + std::ptrdiff_t(level.offset), image.texels().size(),
              image.texels().begin());
  return image;
}

// The share of an image that passes: by bilinear interpolation, at 8 x 8 places in each texel.
double passing_share(const Rgba8Image& image, double threshold, double factor = 1) {
  const auto alpha = [&](int x, int y) {
    return std::min(
        255.0,
        factor *
            image(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1)).a);
  };
  std::int64_t passing = 0;
  for (int y = 0; y < 8 * image.height(); ++y)
    for (int x = 0; x < 8 * image.width(); ++x) {
      const double u = (x + 0.5) / 8 - 0.5, v = (y + 0.5) / 8 - 0.5;
      const int i = int(std::floor(u)), j = int(std::floor(v));
      const double s = u - i, t = v - j;
      const double found = (1 - t) * ((1 - s) * alpha(i, j) + s * alpha(i + 1, j)) +
                           t * ((1 - s) * alpha(i, j + 1) + s * alpha(i + 1, j + 1));
      passing += found >= 255 * threshold;
    }
  return double(passing) / (64.0 * double(image.texels().size()));
}

// The slow twin: of 240 factors, the one whose share is nearest.
TEST(MaskCoverage, no_other_factor_keeps_more_of_the_coverage) {
  std::mt19937 rng(1);
  for (int round = 0; round < 6; ++round) {
    const Rgba8Image image = leaves(rng, 20 + int(rng() % 30), 20 + int(rng() % 30),
                                    10 + int(rng() % 40), 1.0f + float(rng() % 4));
    const float threshold = 0.2f + 0.15f * float(round % 5);
    const double share = passing_share(image, double(threshold));
    const MipChain plain = build_mip_chain(image, true),
                   kept = build_mask_mip_chain(image, true, threshold);
    ASSERT_EQ(kept.texels.size(), plain.texels.size());
    for (std::size_t l = 1; l < plain.levels.size(); ++l) {
      const Rgba8Image before = level_of(plain, l);
      double best = 1;
      for (int k = -120; k < 120; ++k)
        best = std::min(
            best, std::abs(passing_share(before, double(threshold), std::exp2(k / 20.0)) - share));
      // Bytes are rounded, and the shares are of 4 places in each texel instead of 64.
      const double tolerance = 0.02 + 1.0 / double(before.texels().size());
      EXPECT_LE(std::abs(passing_share(level_of(kept, l), double(threshold)) - share),
                best + tolerance)
          << round << " level " << l << " of " << image.width() << " x " << image.height();
    }
  }
}

TEST(MaskCoverage, sparse_leaves_stay_at_every_size_that_can_hold_them) {
  std::mt19937 rng(2);
  const Rgba8Image image = leaves(rng, 256, 256, 300, 4.0f);
  const double share = passing_share(image, 0.5);
  ASSERT_GT(share, 0.1);
  ASSERT_LT(share, 0.3);
  const MipChain plain = build_mip_chain(image, true),
                 kept = build_mask_mip_chain(image, true, 0.5f);
  EXPECT_LT(passing_share(level_of(plain, 5), 0.5), 0.1 * share);  // the fault
  for (std::size_t l = 1; l <= 5; ++l)
    EXPECT_NEAR(passing_share(level_of(kept, l), 0.5), share, 0.1 * share) << l;
}

TEST(MaskCoverage, a_threshold_of_one_can_pass_nothing) {
  // One opaque texel of 64: of the last level, which is one texel, nothing is nearer than all.
  Rgba8Image image(8, 8);
  for (glm::u8vec4& texel : image.texels()) texel = {0, 200, 0, 250};
  for (int k = 0; k < 16; ++k) image(k % 4, k / 4).a = 255;
  EXPECT_LT(build_mask_mip_chain(image, true, 1).texels.back().a, 255);
}

TEST(MaskCoverage, what_is_cut_away_gives_no_color) {
  std::mt19937 rng(3);
  const Rgba8Image image = leaves(rng, 64, 48, 40, 2.0f);
  const MipChain kept = build_mask_mip_chain(image, true, 0.5f);
  for (const glm::u8vec4& texel : kept.texels)
    if (texel.a > 0) {
      EXPECT_EQ(texel.r, 0);
      EXPECT_EQ(texel.g, 200);
      EXPECT_EQ(texel.b, 0);
    }
}

TEST(MaskCoverage, masks_that_pass_all_or_nothing_stay_as_they_are) {
  Rgba8Image image(8, 8);
  for (glm::u8vec4& texel : image.texels()) texel = {10, 20, 30, 100};
  for (float threshold : {0.2f, 0.8f})
    EXPECT_EQ(build_mask_mip_chain(image, true, threshold).texels,
              build_mip_chain(image, true).texels);
  Material material;
  EXPECT_EQ(mask_threshold(material), 0);
  material.alpha_mode = AlphaMode::mask;
  material.alpha_cutoff = 0.4f, material.base_color.a = 0.5f;
  EXPECT_FLOAT_EQ(mask_threshold(material), 0.8f);
  material.base_color.a = 0.3f;
  EXPECT_EQ(mask_threshold(material), 0);
  material.alpha_cutoff = 0;
  EXPECT_EQ(mask_threshold(material), 0);
}

}  // namespace
}  // namespace rilievo

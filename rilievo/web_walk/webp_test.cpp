#include "rilievo/web_walk/webp.h"

#include <gtest/gtest.h>
#include <webp/decode.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

// Smooth shades, hard edges between muted colours, and noise. (Edges between saturated colours are
// beyond lossy WebP: 4:2:0.)
Rgba8Image test_picture(int size) {
  std::mt19937 rng(3);
  Rgba8Image picture(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const int noise = int(rng() % 8), shade = (x + y) * 100 / size;
      const int level = ((x / 16 + y / 16) % 2 == 0 ? 20 : 40) + shade + noise;
      picture(x, y) = glm::u8vec4(level + 12, level + 4, level, 255);
    }
  return picture;
}

TEST(Webp, IsAsExactAsAsked) {
  const Rgba8Image picture = test_picture(96);
  std::size_t before = 0;
  for (const double wanted : {30.0, 36.0, 42.0, 48.0}) {
    const Result<WebpFile> file = encode_webp(picture, {wanted});
    ASSERT_TRUE(file);
    EXPECT_GE(file->psnr_db, wanted);
    EXPECT_GE(file->bytes.size(), before);
    before = file->bytes.size();
    // The figure is that of the bytes.
    int width = 0, height = 0;
    std::uint8_t* rgb = WebPDecodeRGB(file->bytes.data(), file->bytes.size(), &width, &height);
    ASSERT_NE(rgb, nullptr);
    EXPECT_EQ(width, 96);
    EXPECT_EQ(height, 96);
    double sum = 0;
    for (std::size_t i = 0; i < picture.texels().size(); ++i)
      for (int c = 0; c < 3; ++c)
        sum += std::pow(double(rgb[3 * i + std::size_t(c)]) - double(picture.texels()[i][c]), 2);
    WebPFree(rgb);
    if (wanted < 40) {
      EXPECT_LE(file->quality, 100);
    }
    EXPECT_NEAR(file->psnr_db, 10 * std::log10(255.0 * 255 * 3 * 96 * 96 / sum), 1e-9);
  }
}

TEST(Webp, KeepsAlphaExactly) {
  Rgba8Image picture = test_picture(64);
  std::mt19937 rng(5);
  for (glm::u8vec4& texel : picture.texels()) texel.a = std::uint8_t(rng());
  const Result<WebpFile> file = encode_webp(picture, {.least_psnr_db = 36, .alpha = true});
  ASSERT_TRUE(file);
  int width = 0, height = 0;
  std::uint8_t* rgba = WebPDecodeRGBA(file->bytes.data(), file->bytes.size(), &width, &height);
  ASSERT_NE(rgba, nullptr);
  for (std::size_t i = 0; i < picture.texels().size(); ++i)
    EXPECT_EQ(rgba[4 * i + 3], picture.texels()[i].a) << i;
  WebPFree(rgba);
}

TEST(Webp, RefusesWhatTheFormatCannotHold) {
  EXPECT_FALSE(encode_webp(Rgba8Image(), {}));
  EXPECT_FALSE(encode_webp(Rgba8Image(16384, 1), {}));
}

}  // namespace
}  // namespace rilievo

#include "rilievo/io/png.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/jpeg.h"
#include "rilievo/io/picture_decode.h"

namespace rilievo {
namespace {

Rgba8Image random_image(unsigned seed, int width, int height, bool opaque) {
  std::mt19937 rng(seed);
  Rgba8Image image(width, height);
  for (glm::u8vec4& c : image.texels())
    c = {rng() % 256, rng() % 256, rng() % 256, opaque ? 255 : rng() % 256};
  return image;
}

TEST(Png, comes_back_bit_for_bit) {
  const TemporaryFolder folder;
  for (unsigned i = 0; i < 20; ++i) {
    const Rgba8Image image = random_image(i, 1 + int(i * 7 % 40), 1 + int(i * 3 % 17), i % 2);
    ASSERT_TRUE(save_png(folder / "a.png", image).ok());
    const Result<Rgba8Image> back = load_png(folder / "a.png");
    ASSERT_TRUE(back.ok()) << back.error().message();
    EXPECT_TRUE(*back == image);
  }
}

TEST(Png, an_opaque_picture_has_three_channels) {
  // IHDR's colour type is byte 25: 2 is RGB, 6 is RGBA.
  EXPECT_EQ(encode_png(random_image(1, 9, 9, true))[25], 2);
  EXPECT_EQ(encode_png(random_image(1, 9, 9, false))[25], 6);
}

TEST(Png, refuses_what_is_not_a_whole_picture) {
  const TemporaryFolder folder;
  const std::vector<std::uint8_t> whole = encode_png(random_image(3, 30, 20, false));
  const auto reason = [&](std::span<const std::uint8_t> bytes) {
    EXPECT_TRUE(
        write_file(folder / "b.png",
                   std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()))
            .ok());
    const Result<Rgba8Image> loaded = load_png(folder / "b.png");
    return loaded.ok() ? std::string() : loaded.error().reason;
  };
  EXPECT_EQ(reason(whole), "");
  for (std::size_t size = 0; size + 12 < whole.size(); size += 41)
    EXPECT_NE(reason(std::span(whole).first(size)), "") << size;
  // 10000 x 10000 pixels in a file of some 2000 bytes.
  std::vector<std::uint8_t> bomb = whole;
  bomb[18] = bomb[22] = 10000 >> 8, bomb[19] = bomb[23] = 10000 & 255;
  EXPECT_NE(reason(bomb).find("claims"), std::string::npos) << reason(bomb);
  EXPECT_FALSE(load_png(folder / "missing.png").ok());
  EXPECT_FALSE(load_png(folder.path()).ok());
}

// 3: what quality 95 without coarser colours leaves of smooth gradients; measured 1.4.
TEST(Jpeg, comes_back_nearly) {
  Rgba8Image image(61, 37);
  for (int y = 0; y < 37; ++y)
    for (int x = 0; x < 61; ++x) image(x, y) = {4 * x, 6 * y, 255 - 3 * x, 7};
  const std::vector<std::uint8_t> bytes = encode_jpeg(image, 95);
  MemoryBudget budget(1 << 24);
  const Rgba8Image back = decode_picture(bytes, budget);
  ASSERT_EQ(back.width(), 61);
  ASSERT_EQ(back.height(), 37);
  for (std::size_t i = 0; i < back.texels().size(); ++i)
    for (int c = 0; c < 4; ++c)
      ASSERT_NEAR(back.texels()[i][c], c == 3 ? 255 : image.texels()[i][c], 3) << i << " " << c;
}

TEST(Jpeg, is_a_jpeg_and_smaller_at_lower_quality) {
  const Rgba8Image image = random_image(5, 64, 64, true);
  const std::vector<std::uint8_t> fine = encode_jpeg(image, 95), coarse = encode_jpeg(image, 30);
  ASSERT_GT(coarse.size(), 4u);
  EXPECT_EQ(fine[0], 0xFF);
  EXPECT_EQ(fine[1], 0xD8);
  EXPECT_EQ(fine[fine.size() - 1], 0xD9);
  EXPECT_LT(coarse.size(), fine.size());
}

}  // namespace
}  // namespace rilievo

#include "rilievo/io/picture_decode.h"

#include <gtest/gtest.h>
#include <webp/encode.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "rilievo/core/file.h"
#include "rilievo/io/png_test_helpers.h"

namespace rilievo {
namespace {

Rgba8Image random_image(std::mt19937& rng) {
  Rgba8Image image(1 + int(rng() % 40), 1 + int(rng() % 40));
  for (glm::u8vec4& t : image.texels()) t = {rng(), rng(), rng(), rng()};
  return image;
}

std::string reason(const std::string& bytes, std::uint64_t memory = 1 << 24) {
  MemoryBudget budget(memory);
  try {
    (void)decode_picture(bytes_of(bytes), budget);
    return "ok";
  } catch (const LoadFault& fault) {
    return fault.reason;
  }
}

TEST(DecodePicture, png_and_webp_come_back_exactly) {
  std::mt19937 rng(91);
  for (int round = 0; round < 50; ++round) {
    const Rgba8Image image = random_image(rng);
    MemoryBudget budget(1 << 24);
    EXPECT_EQ(decode_picture(bytes_of(test_png::rgba8_png(image)), budget), image);

    std::uint8_t* packed = nullptr;
    const std::size_t size =
        WebPEncodeLosslessRGBA(reinterpret_cast<const std::uint8_t*>(image.texels().data()),
                               image.width(), image.height(), 4 * image.width(), &packed);
    const Rgba8Image back = decode_picture({packed, size}, budget);
    WebPFree(packed);
    ASSERT_EQ(back.width(), image.width());
    ASSERT_EQ(back.height(), image.height());
    for (std::size_t i = 0; i < image.texels().size(); ++i) {
      // The lossless coder may drop the colour of what is fully transparent.
      if (image.texels()[i].a == 0) continue;
      EXPECT_EQ(back.texels()[i], image.texels()[i]);
    }
  }
}

TEST(DecodePicture, damaged_bytes_never_do_harm) {
  std::mt19937 rng(92);
  const std::string good = test_png::rgba8_png(random_image(rng));
  for (int round = 0; round < 2000; ++round) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k) bad[rng() % bad.size()] = char(rng());
    if (round % 3 == 0) bad.resize(rng() % bad.size());
    EXPECT_FALSE(reason(bad).empty());
  }
}

TEST(DecodePicture, memory_is_bounded_by_the_size_it_announces) {
  const std::string good = test_png::rgba8_png(Rgba8Image(100, 100));
  EXPECT_EQ(reason(good), "ok");
  EXPECT_EQ(reason(good, 1000), "needs more memory than the 0 MiB allowed");
  EXPECT_EQ(reason(test_png::head(20000, 100, 8, 6)),
            "is a picture of 20000 x 100 texels; at most 16384 a side can be used");
  EXPECT_EQ(reason("nothing of the kind").substr(0, 38), "is a picture that cannot be decoded: u");
  EXPECT_EQ(reason("\xABKTX 20\xBB\r\n\x1A\n"), "is a KTX2 picture, which is not supported");
}

// More codes of one length than there are bytes: stb_image 2.27 writes 3825 entries into a table of
// 257.
TEST(DecodePicture, a_jpeg_with_too_many_codes_is_refused) {
  std::string jpeg("\xFF\xD8\xFF\xC4\0\x15\0", 7);
  jpeg += std::string(16, '\xFF') + std::string(4000, '\1');
  EXPECT_EQ(reason(jpeg),
            "is a JPEG picture that cannot be decoded: Bogus Huffman table definition");
}

TEST(DecodePicture, jpeg) {
  const char* const data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const Result<std::string> file =
      read_file(std::filesystem::path(data) / "odd_valid/ktx2/kota.jpg", 1 << 24);
  ASSERT_TRUE(file.ok());
  MemoryBudget budget(1 << 24);
  const Rgba8Image image = decode_picture(bytes_of(*file), budget);
  EXPECT_EQ(image.width(), 256);
  EXPECT_EQ(image.height(), 192);
  EXPECT_EQ(image(0, 0).a, 255);
}

}  // namespace
}  // namespace rilievo

#include "rilievo/scene/picture_decode.h"

#include <gtest/gtest.h>
#include <webp/encode.h>

#include <cstdlib>
#include <filesystem>
#include <random>

#include "rilievo/core/file.h"

namespace rilievo {
namespace {

std::string big_endian(std::uint32_t v) {
  return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)};
}

std::uint32_t crc(const std::string& bytes) {
  std::uint32_t c = 0xFFFFFFFFu;
  for (unsigned char b : bytes) {
    c ^= b;
    for (int k = 0; k < 8; ++k) c = c & 1 ? 0xEDB88320u ^ c >> 1 : c >> 1;
  }
  return ~c;
}

std::string chunk(const std::string& type, const std::string& body) {
  return big_endian(std::uint32_t(body.size())) + type + body + big_endian(crc(type + body));
}

// A PNG of 8-bit RGBA, unfiltered, in stored (uncompressed) blocks.
std::string png_of(const Rgba8Image& image) {
  std::string raw, zlib = "\x78\x01";
  for (int y = 0; y < image.height(); ++y) {
    raw += '\0';
    for (const glm::u8vec4& t : image.row(y)) raw += {char(t.r), char(t.g), char(t.b), char(t.a)};
  }
  std::uint32_t a = 1, b = 0;
  for (unsigned char c : raw) a = (a + c) % 65521, b = (b + a) % 65521;
  for (std::size_t at = 0; at < raw.size(); at += 65535) {
    const std::size_t n = std::min<std::size_t>(65535, raw.size() - at);
    zlib += {char(at + n == raw.size()), char(n), char(n >> 8), char(~n), char(~n >> 8)};
    zlib += raw.substr(at, n);
  }
  zlib += big_endian(b << 16 | a);
  return "\x89PNG\r\n\x1A\n" +
         chunk("IHDR", big_endian(std::uint32_t(image.width())) +
                           big_endian(std::uint32_t(image.height())) +
                           std::string("\x08\x06\0\0\0", 5)) +
         chunk("IDAT", zlib) + chunk("IEND", "");
}

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
    EXPECT_EQ(decode_picture(bytes_of(png_of(image)), budget), image);

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
  const std::string good = png_of(random_image(rng));
  for (int round = 0; round < 2000; ++round) {
    std::string bad = good;
    for (int k = 0; k < 3; ++k) bad[rng() % bad.size()] = char(rng());
    if (round % 3 == 0) bad.resize(rng() % bad.size());
    EXPECT_FALSE(reason(bad).empty());
  }
}

TEST(DecodePicture, memory_is_bounded_by_the_size_it_announces) {
  const std::string good = png_of(Rgba8Image(100, 100));
  EXPECT_EQ(reason(good), "ok");
  EXPECT_EQ(reason(good, 1000), "needs more memory than the 0 MiB allowed");
  std::string huge = "\x89PNG\r\n\x1A\n" + chunk("IHDR", big_endian(20000) + big_endian(100) +
                                                             std::string("\x08\x06\0\0\0", 5));
  EXPECT_EQ(reason(huge), "is a picture of 20000 x 100 texels; at most 16384 a side can be used");
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

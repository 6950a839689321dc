#include "rilievo/io/picture_decode.h"

#include <gtest/gtest.h>
#include <png.h>
#include <webp/encode.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

// jpeglib.h needs FILE and size_t from before it.
#include <cstdio>
//
#include <jpeglib.h>

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
  } catch (const LoadError& fault) {
    return fault.reason;
  }
}

// A black picture; in several scans if it is progressive.
std::vector<std::uint8_t> encode_jpeg(int width, int height, bool progressive) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &bytes, &size);
  info.image_width = JDIMENSION(width), info.image_height = JDIMENSION(height);
  info.input_components = 1;
  info.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&info);
  if (progressive) jpeg_simple_progression(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<JSAMPLE> texels(std::size_t(width), 0);
  JSAMPROW row = texels.data();
  for (int y = 0; y < height; ++y) jpeg_write_scanlines(&info, &row, 1);
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  std::vector<std::uint8_t> out(bytes, bytes + size);
  std::free(bytes);
  return out;
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

// Every kind of PNG that there is, written by libpng from random samples. `Sample(x, y, channel)`.
struct PngKind {
  int color_type, bits;
};
constexpr PngKind kPngKinds[] = {
    {PNG_COLOR_TYPE_GRAY, 1},        {PNG_COLOR_TYPE_GRAY, 2},      {PNG_COLOR_TYPE_GRAY, 4},
    {PNG_COLOR_TYPE_GRAY, 8},        {PNG_COLOR_TYPE_GRAY, 16},     {PNG_COLOR_TYPE_RGB, 8},
    {PNG_COLOR_TYPE_RGB, 16},        {PNG_COLOR_TYPE_PALETTE, 1},   {PNG_COLOR_TYPE_PALETTE, 2},
    {PNG_COLOR_TYPE_PALETTE, 4},     {PNG_COLOR_TYPE_PALETTE, 8},   {PNG_COLOR_TYPE_GRAY_ALPHA, 8},
    {PNG_COLOR_TYPE_GRAY_ALPHA, 16}, {PNG_COLOR_TYPE_RGB_ALPHA, 8}, {PNG_COLOR_TYPE_RGB_ALPHA, 16}};

struct WrittenPng {
  std::string bytes;
  Rgba8Image expected;
};

WrittenPng write_png(const PngKind& kind, bool interlaced, bool transparent, std::mt19937& rng) {
  const int width = 1 + int(rng() % 21), height = 1 + int(rng() % 21);
  const bool indexed = kind.color_type == PNG_COLOR_TYPE_PALETTE;
  const int channels = indexed ? 1
                               : 1 + (kind.color_type & PNG_COLOR_MASK_COLOR ? 2 : 0) +
                                     (kind.color_type & PNG_COLOR_MASK_ALPHA ? 1 : 0);
  const int most = (1 << kind.bits) - 1;
  std::vector<png_color> palette(std::size_t(indexed ? most + 1 : 1));
  std::vector<png_byte> alphas(palette.size(), 255);
  for (std::size_t i = 0; i < palette.size(); ++i) {
    palette[i] = {png_byte(rng()), png_byte(rng()), png_byte(rng())};
    if (transparent) alphas[i] = png_byte(rng());
  }
  const png_color_16 clear{0, 1, 1, 1, 1};  // of grey and of colours without alpha

  WrittenPng out{{}, Rgba8Image(width, height)};
  std::vector<std::vector<png_byte>> rows;
  for (int y = 0; y < height; ++y) {
    std::vector<png_byte>& row = rows.emplace_back();
    for (int x = 0; x < width; ++x) {
      int v[4] = {0, 0, 0, most};
      for (int c = 0; c < channels; ++c) {
        v[c] = int(rng() % 3 == 0 ? 1 : rng()) & most;
        if (kind.bits == 16) row.push_back(png_byte(v[c] >> 8));
        row.push_back(png_byte(v[c]));
      }
      glm::u8vec4& texel = out.expected(x, y);
      if (indexed) {
        const png_color& c = palette[std::size_t(v[0])];
        texel = {c.red, c.green, c.blue, alphas[std::size_t(v[0])]};
        continue;
      }
      if (channels <= 2) v[3] = channels == 2 ? v[1] : most, v[1] = v[2] = v[0];
      const bool is_clear = transparent && v[0] == 1 && v[1] == 1 && v[2] == 1;
      // The nearest of 256 steps: 65535 = 257 * 255.
      for (int c = 0; c < 4; ++c) texel[c] = png_byte(std::floor(v[c] * 255.0 / most + 0.5));
      if (is_clear && channels % 2 == 1) texel.a = 0;
    }
  }
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out.bytes,
      [](png_structp to, png_bytep bytes, std::size_t size) {
        static_cast<std::string*>(png_get_io_ptr(to))
            ->append(reinterpret_cast<const char*>(bytes), size);
      },
      nullptr);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), kind.bits, kind.color_type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (indexed) png_set_PLTE(png, info, palette.data(), int(palette.size()));
  if (transparent && indexed) png_set_tRNS(png, info, alphas.data(), int(alphas.size()), nullptr);
  if (transparent && !indexed && channels % 2 == 1) png_set_tRNS(png, info, nullptr, 0, &clear);
  png_set_gAMA(png, info, 1.0);  // to be passed over, as is a profile that is none
  png_write_info_before_PLTE(png, info);
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("iCCP"),
                  reinterpret_cast<png_const_bytep>("nothing of the kind"), 19);
  png_write_info(png, info);
  png_set_packing(png);
  const int passes = png_set_interlace_handling(png);
  for (int pass = 0; pass < passes; ++pass)
    for (const auto& row : rows) png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

TEST(DecodePicture, every_kind_of_png_comes_back_exactly) {
  std::mt19937 rng(93);
  for (const PngKind& kind : kPngKinds)
    for (int round = 0; round < 12; ++round) {
      const bool interlaced = round % 2, transparent = round % 4 >= 2;
      const WrittenPng png = write_png(kind, interlaced, transparent, rng);
      MemoryBudget budget(1 << 24);
      EXPECT_EQ(decode_picture(bytes_of(png.bytes), budget), png.expected)
          << kind.color_type << " " << kind.bits << " " << interlaced << transparent;
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
  EXPECT_EQ(reason(good, 1000), "needs more memory than the 0 MiB that --memory-limit-mb allows");
  EXPECT_EQ(reason(test_png::head(20000, 1, 8, 6) + test_png::tail(std::string(80001, '\0'))),
            "is a picture of 20000 x 1 texels; at most 16384 a side can be used");
  EXPECT_EQ(reason("nothing of the kind").substr(0, 38), "is a picture that cannot be decoded: u");
  EXPECT_EQ(reason("\xABKTX 20\xBB\r\n\x1A\n"), "is a KTX2 picture, which is not supported");
}

// The most that each format makes of a byte, without which a header alone would cost a gigabyte.
TEST(DecodePicture, a_size_that_the_bytes_cannot_hold_is_refused) {
  const std::uint64_t gibibytes = std::uint64_t(4) << 30;
  const std::string claims = "claims 16384 x 16384 texels, more than its bytes can hold";
  const std::string png = test_png::head(16384, 16384, 8, 6) + test_png::tail("few");
  EXPECT_NE(reason(png, gibibytes).find(claims), std::string::npos) << reason(png, gibibytes);
  std::string bmp("BM\0\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\0\x40\0\0\0\x40\0\0\1\0\x18\0", 30);
  bmp.resize(100);
  EXPECT_NE(reason(bmp, gibibytes).find(claims), std::string::npos) << reason(bmp, gibibytes);
  std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\0\x40\0\x40\x20\0", 18);
  tga.resize(100);
  EXPECT_NE(reason(tga, gibibytes).find(claims), std::string::npos) << reason(tga, gibibytes);
  // One row of grey in a baseline JPEG whose height says 16384: libjpeg would make up the rest.
  const std::vector<std::uint8_t> row = encode_jpeg(8, 1, false);
  std::string jpeg(row.begin(), row.end());
  const std::size_t size_at = jpeg.find("\xFF\xC0") + 5;
  jpeg[size_at] = jpeg[size_at + 2] = '\x40', jpeg[size_at + 1] = jpeg[size_at + 3] = 0;
  EXPECT_NE(reason(jpeg, gibibytes).find(claims), std::string::npos) << reason(jpeg, gibibytes);
}

// A decoder's own copy counts against the limit, as the pixels do, but not against what files earn.
TEST(DecodePicture, a_small_file_may_hold_a_large_picture_of_any_format) {
  constexpr int kSide = 600;
  const Rgba8Image black(kSide, kSide, glm::u8vec4(0, 0, 0, 255));
  std::vector<std::string> files = {test_png::rgba8_png(black)};
  std::uint8_t* packed = nullptr;
  const std::size_t size =
      WebPEncodeLosslessRGBA(reinterpret_cast<const std::uint8_t*>(black.texels().data()), kSide,
                             kSide, 4 * kSide, &packed);
  files.emplace_back(packed, packed + size);
  WebPFree(packed);
  for (const bool progressive : {false, true}) {
    const std::vector<std::uint8_t> jpeg = encode_jpeg(kSide, kSide, progressive);
    files.emplace_back(jpeg.begin(), jpeg.end());
  }
  // TGA of runs: 120 times the same texel, so that five runs are a row.
  std::string tga("\0\0\x0A\0\0\0\0\0\0\0\0\0\x58\2\x58\2\x18\x20", 18);
  for (int i = 0; i < 5 * kSide; ++i) tga += std::string("\xF7\0\0\0", 4);
  files.push_back(tga);
  for (const std::string& file : files) {
    MemoryBudget budget(1 << 26);
    budget.take(MemoryBudget::kFree);
    EXPECT_EQ(decode_picture(bytes_of(file), budget), black);
    EXPECT_EQ(reason(file, 4 * kSide * kSide),
              "needs more memory than the 1 MiB that --memory-limit-mb allows");
  }
}

// stb_image had no words for it; to print them ended the program.
TEST(DecodePicture, a_deflate_block_of_an_unknown_type_is_refused_with_a_reason) {
  const std::string png = test_png::head(4, 4, 8, 6) +
                          test_png::chunk("IDAT", std::string("\x78\x01\x07\0\0\0\0\0\0\0", 10)) +
                          test_png::chunk("IEND", "");
  EXPECT_EQ(reason(png), "is a PNG picture that cannot be decoded: IDAT: invalid block type");
}

TEST(DecodePicture, a_png_without_data_is_refused_with_a_reason) {
  const std::string png =
      test_png::head(4, 4, 8, 6) + test_png::chunk("IDAT", "") + test_png::chunk("IEND", "");
  EXPECT_EQ(reason(png), "is a PNG picture that cannot be decoded: Not enough image data");
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

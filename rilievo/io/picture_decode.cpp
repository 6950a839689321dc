#include "rilievo/io/picture_decode.h"

#include <webp/decode.h>

#include <cstdlib>
#include <cstring>
#include <limits>

#include "rilievo/io/jpeg_decode.h"

namespace rilievo {
namespace {

// A few bytes can inflate to gigabytes: no single block that stb_image asks for may be larger than
// this, which is set before each picture to what its size can need.
thread_local std::size_t stb_largest_block = 0;

void* stb_allocate(std::size_t size) {
  return size <= stb_largest_block ? std::malloc(size) : nullptr;
}
void* stb_reallocate(void* block, std::size_t size) {
  return size <= stb_largest_block ? std::realloc(block, size) : nullptr;
}

}  // namespace
}  // namespace rilievo

#define STBI_MALLOC(size) rilievo::stb_allocate(size)
#define STBI_REALLOC(block, size) rilievo::stb_reallocate(block, size)
#define STBI_FREE(block) std::free(block)
#define STBI_ONLY_PNG
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace rilievo {
namespace {

constexpr int kMaxSide = 16384;  // what every OpenGL 4.5 implementation can hold

bool starts_with(Bytes bytes, const char* magic, std::size_t at = 0) {
  const std::size_t n = std::strlen(magic);
  return bytes.size() >= at + n && std::memcmp(bytes.data() + at, magic, n) == 0;
}

void check_size(int width, int height) {
  if (width < 1 || height < 1) refuse("is a picture without texels");
  if (width > kMaxSide || height > kMaxSide)
    refuse("is a picture of " + std::to_string(width) + " x " + std::to_string(height) +
           " texels; at most " + std::to_string(kMaxSide) + " a side can be used");
}

Rgba8Image blank(int width, int height, MemoryBudget& budget) {
  check_size(width, height);
  budget.take(std::uint64_t(width) * std::uint64_t(height), 4);
  return {width, height};
}

Rgba8Image decode_webp(Bytes encoded, MemoryBudget& budget) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(encoded.data(), encoded.size(), &features) != VP8_STATUS_OK)
    refuse("is a WebP picture that is damaged");
  if (features.has_animation) refuse("is an animated WebP picture");
  Rgba8Image out = blank(features.width, features.height, budget);
  const std::size_t bytes = out.texels().size() * 4;
  if (!WebPDecodeRGBAInto(encoded.data(), encoded.size(),
                          reinterpret_cast<std::uint8_t*>(out.texels().data()), bytes,
                          4 * features.width))
    refuse("is a WebP picture that is damaged");
  return out;
}

int stb_size(Bytes encoded) {
  if (encoded.size() > std::size_t(std::numeric_limits<int>::max()))
    refuse("is a picture of more than 2 GiB");
  return int(encoded.size());
}

// The most that stb_image needs: four channels of two bytes and a filter byte a row; and the
// compressed bytes, both in blocks that grow by doubling.
void limit_stb(int width, int height, Bytes encoded, const MemoryBudget& budget) {
  const std::size_t raw = std::size_t(width) * std::size_t(height) * 8 + std::size_t(height);
  stb_largest_block = 2 * raw + 2 * encoded.size() + (1 << 16);
  budget.borrow(2 * stb_largest_block);
}

Rgba8Image decode_stb(Bytes encoded, MemoryBudget& budget) {
  const int size = stb_size(encoded);
  int width = 0, height = 0, channels = 0;
  stb_largest_block = 1 << 20;
  if (!stbi_info_from_memory(encoded.data(), size, &width, &height, &channels))
    refuse(std::string("is a picture that cannot be decoded: ") + stbi_failure_reason());
  Rgba8Image out = blank(width, height, budget);
  limit_stb(width, height, encoded, budget);
  stbi_uc* const texels =
      stbi_load_from_memory(encoded.data(), size, &width, &height, &channels, 4);
  if (!texels) refuse(std::string("is a picture that cannot be decoded: ") + stbi_failure_reason());
  if (width == out.width() && height == out.height())
    std::memcpy(out.texels().data(), texels, out.texels().size() * 4);
  std::free(texels);
  return out;
}

}  // namespace

Rgba8Image decode_picture(Bytes encoded, MemoryBudget& budget) {
  if (starts_with(encoded, "RIFF") && starts_with(encoded, "WEBP", 8))
    return decode_webp(encoded, budget);
  if (starts_with(encoded, "\xABKTX 20\xBB")) refuse("is a KTX2 picture, which is not supported");
  if (starts_with(encoded, "DDS ")) refuse("is a DDS picture, which is not supported");
  if (starts_with(encoded, "\xFF\xD8\xFF")) return decode_jpeg(encoded, budget, blank);
  return decode_stb(encoded, budget);
}

Image<std::uint16_t> decode_grey16(Bytes encoded, MemoryBudget& budget) {
  const int size = stb_size(encoded);
  int width = 0, height = 0, channels = 0;
  stb_largest_block = 1 << 20;
  if (!starts_with(encoded, "\x89PNG") ||
      !stbi_info_from_memory(encoded.data(), size, &width, &height, &channels) || channels != 1 ||
      !stbi_is_16_bit_from_memory(encoded.data(), size))
    refuse("is not a PNG picture of 16-bit grey");
  check_size(width, height);
  budget.take(std::uint64_t(width) * std::uint64_t(height), 2);
  limit_stb(width, height, encoded, budget);
  stbi_us* const texels =
      stbi_load_16_from_memory(encoded.data(), size, &width, &height, &channels, 1);
  if (!texels) refuse(std::string("is a picture that cannot be decoded: ") + stbi_failure_reason());
  Image<std::uint16_t> out(width, height);
  std::memcpy(out.texels().data(), texels, out.texels().size_bytes());
  std::free(texels);
  return out;
}

}  // namespace rilievo

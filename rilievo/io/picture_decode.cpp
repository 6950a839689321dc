#include "rilievo/io/picture_decode.h"

#include <webp/decode.h>

#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

#include "rilievo/io/jpeg_decode.h"
#include "rilievo/io/png_decode.h"

namespace rilievo {
namespace {

// No single block that stb_image asks for may be larger than this, which is set before each picture
// to what its size can need.
thread_local std::size_t stb_largest_block = 0;

void* stb_allocate(std::size_t size) {
  return size <= stb_largest_block ? std::malloc(size) : nullptr;
}

}  // namespace
}  // namespace rilievo

#define STBI_MALLOC(size) rilievo::stb_allocate(size)
#define STBI_REALLOC(block, size) nullptr  // for PNG and GIF alone
#define STBI_FREE(block) std::free(block)
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

template <class Texel>
Image<Texel> blank(int width, int height, MemoryBudget& budget) {
  check_size(width, height);
  budget.take_pixels(std::uint64_t(width) * std::uint64_t(height), sizeof(Texel));
  return {width, height};
}

Rgba8Image decode_webp(Bytes encoded, MemoryBudget& budget) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(encoded.data(), encoded.size(), &features) != VP8_STATUS_OK)
    refuse("is a WebP picture that is damaged");
  if (features.has_animation) refuse("is an animated WebP picture");
  Rgba8Image out = blank<glm::u8vec4>(features.width, features.height, budget);
  // Lossless pictures are decoded whole before they are copied; of lossy ones, only the alpha.
  const bool lossy = features.format == 1;
  budget.borrow_pixels(out.texels().size(), lossy ? 2 * features.has_alpha : 4);
  if (!WebPDecodeRGBAInto(encoded.data(), encoded.size(),
                          reinterpret_cast<std::uint8_t*>(out.texels().data()),
                          out.texels().size_bytes(), 4 * features.width))
    refuse("is a WebP picture that is damaged");
  return out;
}

[[noreturn]] void fail_stb() {
  // It does not always say why.
  const char* const why = stbi_failure_reason();
  refuse(std::string("is a picture that cannot be decoded: ") +
         (why && *why ? why : "its bytes are damaged"));
}

// BMP and TGA. stb_image takes what is cut short for zeros, so that a few bytes could stand for any
// picture: BMP has at least one bit a texel, TGA at least 2 bytes for 128 texels that repeat.
Rgba8Image decode_stb(Bytes encoded, MemoryBudget& budget) {
  if (encoded.size() > std::size_t(std::numeric_limits<int>::max()))
    refuse("is a picture of more than 2 GiB");
  const int size = int(encoded.size());
  int width = 0, height = 0, channels = 0;
  stb_largest_block = 1 << 20;
  if (!stbi_info_from_memory(encoded.data(), size, &width, &height, &channels)) fail_stb();
  check_size(width, height);
  const std::uint64_t texels = std::uint64_t(width) * std::uint64_t(height);
  if (texels > (starts_with(encoded, "BM") ? 8 : 64) * std::uint64_t(encoded.size()))
    refuse("is a picture that claims " + std::to_string(width) + " x " + std::to_string(height) +
           " texels, more than its bytes can hold");
  // Four channels as they come, four as they are asked for; one of both is freed before the copy.
  stb_largest_block = 4 * texels + 4096;
  Rgba8Image out = blank<glm::u8vec4>(width, height, budget);
  budget.borrow_pixels(texels, 4);
  const std::unique_ptr<stbi_uc, void (*)(void*)> decoded(
      stbi_load_from_memory(encoded.data(), size, &width, &height, &channels, 4), std::free);
  if (!decoded) fail_stb();
  if (width != out.width() || height != out.height())
    refuse("is a picture that cannot be decoded: its header contradicts itself");
  std::memcpy(out.texels().data(), decoded.get(), out.texels().size_bytes());
  return out;
}

}  // namespace

Rgba8Image decode_picture(Bytes encoded, MemoryBudget& budget) {
  if (is_png(encoded)) return decode_png(encoded, budget, blank<glm::u8vec4>);
  if (starts_with(encoded, "\xFF\xD8\xFF")) return decode_jpeg(encoded, budget, blank<glm::u8vec4>);
  if (starts_with(encoded, "RIFF") && starts_with(encoded, "WEBP", 8))
    return decode_webp(encoded, budget);
  if (starts_with(encoded, "\xABKTX 20\xBB")) refuse("is a KTX2 picture, which is not supported");
  if (starts_with(encoded, "DDS ")) refuse("is a DDS picture, which is not supported");
  return decode_stb(encoded, budget);
}

Image<std::uint16_t> decode_grey16(Bytes encoded, MemoryBudget& budget) {
  return decode_png_grey16(encoded, budget, blank<std::uint16_t>);
}

}  // namespace rilievo

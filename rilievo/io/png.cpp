#include "rilievo/io/png.h"

// Private copies: other stages and other libraries may hold their own.
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cstring>
#include <memory>

#include "rilievo/core/file.h"

namespace rilievo {
namespace {

// DEFLATE makes of one byte at most 1032, and a PNG pixel takes at least one bit.
constexpr double kPixelsPerByte = 8 * 1032.0;
constexpr std::uint64_t kMostBytes = 1u << 30;
constexpr double kMostPixels = double(1 << 28);

void append(void* context, void* data, int size) {
  auto* out = static_cast<std::vector<std::uint8_t>*>(context);
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  out->insert(out->end(), bytes, bytes + size);
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Rgba8Image& picture) {
  RILIEVO_EXPECTS(!picture.empty());
  const int w = picture.width(), h = picture.height();
  const bool opaque = std::all_of(picture.texels().begin(), picture.texels().end(),
                                  [](const glm::u8vec4& c) { return c.a == 255; });
  std::vector<std::uint8_t> out;
  if (!opaque) {
    stbi_write_png_to_func(append, &out, w, h, 4, picture.texels().data(), 4 * w);
    return out;
  }
  std::vector<glm::u8vec3> rgb(picture.texels().begin(), picture.texels().end());
  stbi_write_png_to_func(append, &out, w, h, 3, rgb.data(), 3 * w);
  return out;
}

Result<> save_png(const std::filesystem::path& path, const Rgba8Image& picture) {
  const std::vector<std::uint8_t> bytes = encode_png(picture);
  const std::span<const std::byte> piece = std::as_bytes(std::span(bytes));
  return write_file(path, std::span(&piece, 1));
}

Result<Rgba8Image> load_png(const std::filesystem::path& path) {
  const auto error = [&](const std::string& reason) { return Error{path.string(), reason}; };
  const Result<std::string> file = read_file(path, kMostBytes);
  if (!file) return file.error();
  const auto* bytes = reinterpret_cast<const stbi_uc*>(file->data());
  const int size = int(file->size());

  int w = 0, h = 0, channels = 0;
  if (!stbi_info_from_memory(bytes, size, &w, &h, &channels)) return error("is not a PNG picture");
  if (double(w) * h > std::min(kMostPixels, kPixelsPerByte * size))
    return error("claims " + std::to_string(w) + " x " + std::to_string(h) +
                 " pixels, more than its bytes can hold");
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes, size, &w, &h, &channels, 4), stbi_image_free);
  if (!pixels) return error(std::string("is a damaged PNG picture: ") + stbi_failure_reason());
  Rgba8Image out(w, h);
  std::memcpy(out.texels().data(), pixels.get(), out.texels().size_bytes());
  return out;
}

}  // namespace rilievo

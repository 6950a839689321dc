#include "rilievo/io/jpeg.h"

// A private copy: other stages and other libraries may hold their own.
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace rilievo {
namespace {

void append(void* context, void* data, int size) {
  auto* out = static_cast<std::vector<std::uint8_t>*>(context);
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  out->insert(out->end(), bytes, bytes + size);
}

}  // namespace

std::vector<std::uint8_t> encode_jpeg(const Rgba8Image& picture, int quality) {
  RILIEVO_EXPECTS(!picture.empty());
  RILIEVO_EXPECTS(1 <= quality && quality <= 100);
  std::vector<std::uint8_t> out;
  stbi_write_jpg_to_func(append, &out, picture.width(), picture.height(), 4,
                         picture.texels().data(), quality);
  return out;
}

}  // namespace rilievo

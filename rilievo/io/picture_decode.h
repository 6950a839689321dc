// How are the texels of an encoded picture decoded? Internal to loading; throws LoadError.
//
// PNG by libpng, JPEG by libjpeg, WebP by libwebp, BMP and TGA by stb_image; the first bytes
// decide. stb_image reads no compressed formats here: version 2.27 writes past its tables on a
// damaged JPEG and gives no reason for a damaged PNG.
#pragma once

#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

// 8-bit RGBA with straight alpha, row 0 on top, at most 16384 texels a side.
[[nodiscard]] Rgba8Image decode_picture(Bytes encoded, MemoryBudget& budget);

// The values of a 16-bit grey PNG (a depth image); throws for any other picture.
[[nodiscard]] Image<std::uint16_t> decode_grey16(Bytes encoded, MemoryBudget& budget);

}  // namespace rilievo

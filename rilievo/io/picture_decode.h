// The texels of an encoded picture: PNG by libpng, JPEG by libjpeg, WebP by libwebp, BMP and TGA by
// stb_image. Which it is, the first bytes say. Internal to loading; throws LoadFault.
//
// Damaged files take the libraries for formats that compress: stb_image 2.27 writes past its tables
// on a damaged JPEG, and gives no reason for a damaged PNG.
#pragma once

#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

// Eight bits a channel, alpha straight, row 0 on top, at most 16384 texels a side.
[[nodiscard]] Rgba8Image decode_picture(Bytes encoded, MemoryBudget& budget);

// The numbers of a PNG of 16-bit grey, as depth is kept in; anything else is refused.
[[nodiscard]] Image<std::uint16_t> decode_grey16(Bytes encoded, MemoryBudget& budget);

}  // namespace rilievo

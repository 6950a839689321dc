// The texels of an encoded picture: JPEG by libjpeg (stb_image 2.27 writes past its tables on a
// damaged one), WebP by libwebp, PNG, BMP and TGA by stb_image. Which it is, the first bytes say.
// Internal to loading; throws LoadFault.
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

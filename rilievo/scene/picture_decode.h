// The texels of an encoded picture: PNG and JPEG (also BMP and TGA) by stb_image, WebP by libwebp.
// Which of them it is, the first bytes say. Internal to loading; throws LoadFault.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/scene/load_context.h"

namespace rilievo {

// Eight bits a channel, alpha straight, row 0 on top, at most 16384 texels a side.
[[nodiscard]] Rgba8Image decode_picture(Bytes encoded, MemoryBudget& budget);

}  // namespace rilievo

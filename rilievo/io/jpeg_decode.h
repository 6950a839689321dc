// JPEG by libjpeg. Internal to loading; throws LoadFault.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

// Calls `make(width, height)` for the picture to fill, which may refuse.
[[nodiscard]] Rgba8Image decode_jpeg(Bytes encoded, MemoryBudget& budget,
                                     Rgba8Image (*make)(int width, int height, MemoryBudget&));

}  // namespace rilievo

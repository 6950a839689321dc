// How is a JPEG file decoded? By libjpeg. Internal to loading; throws LoadError.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

// Decodes into the picture that `make(width, height)` returns; `make` may refuse by throwing.
[[nodiscard]] Rgba8Image decode_jpeg(Bytes encoded, MemoryBudget& budget,
                                     Rgba8Image (*make)(int width, int height, MemoryBudget&));

}  // namespace rilievo

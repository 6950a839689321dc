// How do frames become small enough for a report? As baseline JPEG in memory.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/color.h"

namespace rilievo {

// Encodes a picture of at least one pixel; alpha is dropped. `quality` is 1 to 100; about 90 shows
// no block artefacts.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const Rgba8Image& picture, int quality = 85);

}  // namespace rilievo

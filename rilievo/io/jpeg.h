// How do frames become small enough for a report?
//
// As baseline JPEG, in memory; alpha is dropped. `quality` from 1 to 100; about 90 shows no
// blocks.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/color.h"

namespace rilievo {

// Requires a picture of at least one pixel.
[[nodiscard]] std::vector<std::uint8_t> encode_jpeg(const Rgba8Image& picture, int quality = 85);

}  // namespace rilievo

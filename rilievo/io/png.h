// How do 8-bit pictures become PNG files and come back?
//
// sRGB colour and straight alpha, as PNG defines them: what goes in comes back bit for bit. No
// colour management: gamma and profile chunks are ignored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/core/result.h"

namespace rilievo {

// A PNG file in memory: RGB if every alpha is 255, else RGBA. Requires a picture of at least one
// pixel.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Rgba8Image& picture);

// Replaces the file at once or not at all.
[[nodiscard]] Result<> save_png(const std::filesystem::path& path, const Rgba8Image& picture);

// Any PNG: grey, palette and 16 bits become RGBA with 8. Refuses files that claim more pixels than
// their bytes can hold, and more than 16384 a side.
[[nodiscard]] Result<Rgba8Image> load_png(const std::filesystem::path& path);

}  // namespace rilievo

// 8-bit pictures as PNG files.
//
// Colours are sRGB, alpha is straight, as PNG defines them; loading returns exactly what was saved.
// There is no colour management: gamma and profile chunks are ignored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/core/result.h"

namespace rilievo {

// A PNG file in memory, RGB if every alpha is 255 and RGBA otherwise. Requires a picture of at
// least one pixel.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Rgba8Image& picture);

// Saves a picture. The file is replaced at once or not at all.
[[nodiscard]] Result<> save_png(const std::filesystem::path& path, const Rgba8Image& picture);

// Loads any PNG; grey, palette and 16-bit pictures become 8-bit RGBA. Refuses files that claim more
// pixels than their bytes can hold, and more than 16384 pixels a side.
[[nodiscard]] Result<Rgba8Image> load_png(const std::filesystem::path& path);

}  // namespace rilievo

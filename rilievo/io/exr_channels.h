// How are single channels of an OpenEXR file read and written by name?
//
// For formats that store their cameras elsewhere and name channels themselves (Seurat's captures).
// Reads the first part's data window as floats, row 0 on top, the base level of a tiled part.
// Refuses deep parts, sub-sampled and missing channels, and files that claim more texels than their
// bytes can hold. Runs in the caller's thread.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/image.h"
#include "rilievo/core/result.h"

namespace rilievo {

// Loads one plane for each name, in the order of `names`.
[[nodiscard]] Result<std::vector<Image<float>>> load_exr_channels(
    const std::filesystem::path& path, std::span<const std::string> names);

// Saves planes of one size under their names. The file is replaced at once or not at all.
[[nodiscard]] Result<> save_exr_channels(const std::filesystem::path& path,
                                         std::span<const std::string> names,
                                         std::span<const Image<float>> planes);

}  // namespace rilievo

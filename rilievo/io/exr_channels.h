// What do the channels of an OpenEXR file hold, whatever they mean?
//
// For formats that keep their cameras elsewhere and name channels themselves (Seurat's captures).
// The first part's data window, as floats, row 0 on top; of a tiled part the base level. Deep
// parts, sub-sampled and missing channels and files that claim more than their bytes can hold are
// refused. The caller's thread.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "rilievo/core/image.h"
#include "rilievo/core/result.h"

namespace rilievo {

// In the order of `names`.
[[nodiscard]] Result<std::vector<Image<float>>> load_exr_channels(
    const std::filesystem::path& path, std::span<const std::string> names);

// Names and planes of one size each; replaces the file at once or not at all.
[[nodiscard]] Result<> save_exr_channels(const std::filesystem::path& path,
                                         std::span<const std::string> names,
                                         std::span<const Image<float>> planes);

}  // namespace rilievo

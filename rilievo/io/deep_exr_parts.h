// A part of an OpenEXR file as a LayeredDepthImage.
//
// Internal to `io`. Errors carry no path: whoever opened the file adds it.
#pragma once

#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>

#include "rilievo/io/deep_exr.h"

namespace rilievo::exr {

// Deep, and written by Rilievo?
[[nodiscard]] bool is_own_deep_part(const Imf::Header& header);

// Without samples, only name and camera are read. Throws OpenEXR's exceptions.
[[nodiscard]] Result<LayeredDepthImage> read_layers(Imf::MultiPartInputFile& file, int part,
                                                    double file_bytes,
                                                    const DeepLoadOptions& options,
                                                    bool with_samples = true);

}  // namespace rilievo::exr

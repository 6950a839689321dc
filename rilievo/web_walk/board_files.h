// Nailboards as files for browsers (web_walk/walk.h).
#pragma once

#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/web_walk/walk_writer.h"

namespace rilievo {

// Writes perspective pictures as nailboards with 16 bits of depth, and adds them to `manifest`. The
// error names the picture.
[[nodiscard]] Result<> add_boards(std::span<const DepthImage> pictures, WalkWriter& writer,
                                  WalkManifest& manifest, const WalkOptions& options);

}  // namespace rilievo

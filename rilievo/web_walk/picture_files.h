// Layered impostors and nailboards as files for browsers (web_walk/walk.h).
#pragma once

#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/web_walk/walk_writer.h"

namespace rilievo {

// Writes the pictures of a layered impostor and adds them to `manifest`.
[[nodiscard]] Result<> add_layered_impostor(const LayeredImpostor& impostor, WalkWriter& writer,
                                            WalkManifest& manifest, const WalkOptions& options);

// The same of pictures that are drawn as nailboards, with `delta_bits` (2 to 16) of depth. Fails
// for those that are not perspective.
[[nodiscard]] Result<> add_nailboards(std::span<const DepthImage> pictures, int delta_bits,
                                      WalkWriter& writer, WalkManifest& manifest,
                                      const WalkOptions& options);

}  // namespace rilievo

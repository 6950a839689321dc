// Layered impostors and nailboards as files for browsers (web_walk/walk.h).
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "rilievo/core/color.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/layered_impostor/layered_impostor.h"
#include "rilievo/web_walk/walk_writer.h"

namespace rilievo {

// Colours in a file, and their PSNR over black.
struct WalkColors {
  WalkFile file;
  double psnr_db = 0;
};
// Writes colours with alpha, not multiplied by it, as WebP.
[[nodiscard]] Result<WalkColors> write_colors(Rgba8Image colors, WalkWriter& writer,
                                              const WalkOptions& options);

// Calls `write` for pictures 0 to `count` - 1, several at a time, and tells options.progress. The
// error names the picture.
[[nodiscard]] Result<> write_each(std::size_t count, const WalkOptions& options,
                                  const std::function<Result<>(std::size_t)>& write);

// Writes the pictures of a layered impostor and adds them to `manifest`.
[[nodiscard]] Result<> add_layered_impostor(const LayeredImpostor& impostor, WalkWriter& writer,
                                            WalkManifest& manifest, const WalkOptions& options);

// The same of pictures that are drawn as nailboards, with `delta_bits` (2 to 16) of depth. Fails
// for those that are not perspective.
[[nodiscard]] Result<> add_nailboards(std::span<const DepthImage> pictures, int delta_bits,
                                      WalkWriter& writer, WalkManifest& manifest,
                                      const WalkOptions& options);

}  // namespace rilievo

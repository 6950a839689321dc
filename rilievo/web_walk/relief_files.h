// Layered reliefs as files for browsers (web_walk/walk.h).
#pragma once

#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/web_walk/walk_writer.h"

namespace rilievo {

// Writes reliefs, which are to be drawn with `draw`, and adds them to `manifest`. Fails if one has
// more samples than a sheet of 4096 x 4096 texels holds.
[[nodiscard]] Result<> add_reliefs(const ReliefPictures& pictures, const PrewarpOptions& draw,
                                   WalkWriter& writer, WalkManifest& manifest,
                                   const WalkOptions& options);

}  // namespace rilievo

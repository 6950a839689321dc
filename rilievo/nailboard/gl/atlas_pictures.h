// Pictures with depth as nailboards in an atlas of textures.
#pragma once

#include <span>

#include "rilievo/core/picture_geometry.h"
#include "rilievo/core/result.h"
#include "rilievo/nailboard/picture_set.h"

namespace rilievo {

// Accepts perspective pictures of at most 1024 texels a side; the error names the first other one.
// Needs a current OpenGL context.
[[nodiscard]] Result<PictureSet> make_atlas_pictures(std::span<const DepthImage> pictures,
                                                     DepthMode mode = DepthMode::exact,
                                                     int delta_bits = 8);

}  // namespace rilievo

// Pictures with depth as nailboards in memory.
#pragma once

#include <span>

#include "rilievo/core/picture_geometry.h"
#include "rilievo/core/result.h"
#include "rilievo/nailboard/picture_set.h"

namespace rilievo {

// Accepts perspective pictures of at most 16383 texels a side; the error names the first other one.
[[nodiscard]] Result<PictureSet> make_software_pictures(std::span<const DepthImage> pictures,
                                                        DepthMode mode = DepthMode::exact,
                                                        int delta_bits = 8);

}  // namespace rilievo

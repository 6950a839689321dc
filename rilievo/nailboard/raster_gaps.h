// How wide is the strip that a picture is missing, if the rasteriser has captured it?
#pragma once

#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/nailboard/gap_table.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// The gap table of a picture that `camera` captured. `farthest`: the window_z of the farthest
// surfaces of the same objects, as PictureRasterizer::draw_farthest() draws them.
[[nodiscard]] GapTable raster_gaps(const RasterPicture& picture, std::span<const float> farthest,
                                   const Camera& camera);

}  // namespace rilievo

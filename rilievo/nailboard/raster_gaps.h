// How wide is the strip that a picture is missing, if the rasteriser has captured it?
#pragma once

#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/nailboard/gap_table.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// The gap table of a picture that `camera` has captured of some objects, of whose farthest surfaces
// the window_z are known (PictureRasterizer::draw_farthest).
[[nodiscard]] GapTable raster_gaps(const RasterPicture& picture, std::span<const float> farthest,
                                   const Camera& camera);

}  // namespace rilievo

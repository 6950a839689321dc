// How wide is the strip that a picture is missing, if the rasteriser has captured it?
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/capture/raster_source.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo {

// The gap table of the picture of `objects` that `source` has drawn last.
[[nodiscard]] GapTable raster_gaps(RasterSource& source, const Camera& camera,
                                   std::span<const std::uint32_t> objects);

}  // namespace rilievo

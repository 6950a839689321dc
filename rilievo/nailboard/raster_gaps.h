// How wide is the strip that a picture is missing, if the rasteriser has captured it?
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/capture/capture_without_opengl.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo {

// The gap table of the picture of `objects`, placed by `poses` (of all objects), that `capturer`
// has just made.
[[nodiscard]] GapTable raster_gaps(CaptureWithoutOpenGL& capturer, const Camera& camera,
                                   std::span<const std::uint32_t> objects,
                                   std::span<const glm::mat4> poses);

}  // namespace rilievo

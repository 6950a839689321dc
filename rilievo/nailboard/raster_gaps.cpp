#include "rilievo/nailboard/raster_gaps.h"

#include "rilievo/core/expects.h"

namespace rilievo {

GapTable raster_gaps(const RasterPicture& picture, std::span<const float> farthest,
                     const Camera& camera) {
  RILIEVO_EXPECTS(picture.width == camera.width && picture.height == camera.height);
  return make_gap_table(eye_z_from_window_z(picture.depth, camera),
                        eye_z_from_window_z(farthest, camera));
}

}  // namespace rilievo

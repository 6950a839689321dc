#include "rilievo/nailboard/raster_gaps.h"

#include "rilievo/core/expects.h"

namespace rilievo {

GapTable raster_gaps(RasterSource& source, const Camera& camera,
                     std::span<const std::uint32_t> objects) {
  const RasterPicture& picture = source.picture();
  RILIEVO_EXPECTS(picture.width == camera.width && picture.height == camera.height);
  return make_gap_table(eye_z_from_window_z(picture.depth, camera),
                        eye_z_from_window_z(source.draw_farthest(camera, objects), camera));
}

}  // namespace rilievo

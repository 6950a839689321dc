#include "rilievo/represent/picture_geometry.h"

#include <algorithm>

namespace rilievo {

// A flat sample's parallax for a small eye offset r is r |1/plane - 1/d|. The two ends of the slab
// are alike when 1/plane is the mean of 1/front and 1/back.
double best_plane(DepthSlab slab) noexcept {
  return std::clamp(2 * slab.front * slab.back / (slab.front + slab.back), slab.front, slab.back);
}

PictureGeometry picture_geometry(const Camera& capture) {
  PictureGeometry picture;
  picture.capture = capture;
  picture.slab = {capture.z_near, capture.z_far};
  picture.plane_z = best_plane(picture.slab);
  return picture;
}

}  // namespace rilievo

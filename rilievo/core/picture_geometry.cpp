#include "rilievo/core/picture_geometry.h"

#include <algorithm>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"

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

DepthSlab part_of(DepthSlab whole, const DeltaRange& range) {
  RILIEVO_EXPECTS(0 <= range.nearest && range.nearest <= range.farthest && range.farthest <= 1);
  // Delta is affine in 1 / eye_z.
  const double near = 1 / whole.front, far = 1 / whole.back;
  return {1 / (near + range.nearest * (far - near)), 1 / (near + range.farthest * (far - near))};
}

void narrow_slab(PictureGeometry& picture, DeltaRange range) {
  const double half_step =
      picture.delta_bits == 0 ? 0 : 0.5 / double(delta_steps(picture.delta_bits));
  range.nearest = std::max(0.0, range.nearest - half_step);
  range.farthest = std::min(1.0, range.farthest + half_step);
  picture.slab = part_of({picture.capture.z_near, picture.capture.z_far}, range);
  picture.plane_z = best_plane(picture.slab);
}

}  // namespace rilievo

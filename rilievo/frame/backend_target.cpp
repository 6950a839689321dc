#include "rilievo/frame/backend_target.h"

namespace rilievo {

DepthImage read_picture(const BackendTarget& target, const Camera& camera) {
  DepthImage picture;
  picture.name = "frame";
  picture.camera = camera;
  picture.depth_kind = DepthKind::eye_z;
  picture.color = linear_from_srgb8(target.color());
  picture.depth = target.eye_z();
  return picture;
}

}  // namespace rilievo

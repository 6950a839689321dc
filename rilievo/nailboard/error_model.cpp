#include "rilievo/nailboard/error_model.h"

#include "rilievo/nailboard/error.h"

namespace rilievo {
namespace {

double nailboard_bound_px(const ErrorModel& model, const glm::dmat4& world_from_capture,
                          const Camera& frame) {
  return bound_total_px(model.load<PictureGeometry>(), frame, {world_from_capture});
}

}  // namespace

ErrorModel nailboard_error_model(const PictureGeometry& geometry) {
  ErrorModel model;
  model.bound = nailboard_bound_px;
  model.texel = geometry.plane_z * (geometry.capture.window.right - geometry.capture.window.left) /
                geometry.capture.width;
  model.store(geometry);
  return model;
}

}  // namespace rilievo

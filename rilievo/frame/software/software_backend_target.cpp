#include "rilievo/frame/software/software_backend_target.h"

#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {

Result<> SoftwareBackendTarget::draw(FrameSource& source, const Camera& camera, double time) {
  const Stopwatch watch;
  if (Result<> drawn = source.draw(camera, time); !drawn) return drawn;
  frame_ms_ = watch.ms();
  // Only now: a source that changes its method has another one from then on.
  frame_ = source.software_target();
  RILIEVO_EXPECTS(frame_ != nullptr);
  return Done{};
}

Result<SeenObjects> SoftwareBackendTarget::draw_objects(FrameSource& source) {
  if (Result<> drawn = source.draw_objects(); !drawn) return drawn.error();
  return SeenObjects{frame_->objects(), frame_->eye_z()};
}

}  // namespace rilievo

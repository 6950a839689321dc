#include "rilievo/frame/gl/opengl_target.h"

#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context.h"

namespace rilievo {

Result<OpenGLTarget> OpenGLTarget::create(int width, int height, int samples) {
  Result<FrameTarget> frame = FrameTarget::create(width, height, samples);
  if (!frame) return frame.error();
  OpenGLTarget target;
  target.frame_ = std::move(*frame);
  return target;
}

Result<> OpenGLTarget::draw(FrameSource& source, const Camera& camera, double time) {
  camera_ = camera;
  gl::finish();
  const Stopwatch watch;
  frame_.begin();
  if (Result<> drawn = source.draw(camera, time); !drawn) return drawn;
  frame_.resolve();
  gl::finish();
  frame_ms_ = watch.ms();
  return Done{};
}

Result<SeenObjects> OpenGLTarget::draw_objects(FrameSource& source) {
  if (!probe_) {
    Result<ProbeTarget> made = ProbeTarget::create(frame_.width(), frame_.height());
    if (!made) return made.error();
    probe_ = std::move(*made);
  }
  probe_->begin();
  if (Result<> drawn = source.draw_objects(); !drawn) return drawn.error();
  return SeenObjects{probe_->read_objects(), probe_->read_eye_z(camera_)};
}

}  // namespace rilievo

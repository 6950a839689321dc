#include "rilievo/compare/drawn_frame.h"

#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

Result<double> time_frame(FrameSource& source, const DrawTargets& targets, const WalkFrame& frame) {
  if (source.software_target()) {
    const Stopwatch watch;
    if (Result<> drawn = source.draw(frame.camera, frame.time); !drawn) return drawn.error();
    return watch.ms();
  }
  RILIEVO_EXPECTS(targets.frame != nullptr);
  gl::finish();
  const Stopwatch watch;
  targets.frame->begin();
  if (Result<> drawn = source.draw(frame.camera, frame.time); !drawn) return drawn.error();
  targets.frame->resolve();
  gl::finish();
  return watch.ms();
}

Rgba8Image read_frame(const FrameSource& source, const DrawTargets& targets) {
  if (const SoftwareTarget* memory = source.software_target()) return memory->color();
  RILIEVO_EXPECTS(targets.frame != nullptr);
  return targets.frame->read();
}

Result<DrawnFrame> draw_frame(FrameSource& source, const DrawTargets& targets,
                              const WalkFrame& frame, int error_step) {
  const Result<double> ms = time_frame(source, targets, frame);
  if (!ms) return ms.error();
  DrawnFrame drawn{*ms, source.stats(), read_frame(source, targets)};
  if (error_step > 0) source.append_errors(error_step, drawn.errors_px);
  const SoftwareTarget* memory = source.software_target();
  if (!memory) {
    RILIEVO_EXPECTS(targets.probe != nullptr);
    targets.probe->begin();
  }
  if (Result<> probed = source.draw_objects(); !probed) return probed.error();
  drawn.objects = memory ? memory->objects() : targets.probe->read_objects();
  drawn.eye_z = memory ? memory->eye_z() : targets.probe->read_eye_z(frame.camera);
  return drawn;
}

}  // namespace rilievo

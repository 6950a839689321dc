#include "rilievo/compare/drawn_frame.h"

#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context.h"

namespace rilievo {

Result<double> time_frame(FrameSource& source, FrameTarget& target, const WalkFrame& frame) {
  gl::finish();
  const Stopwatch watch;
  target.begin();
  if (Result<> drawn = source.draw(frame.camera, frame.time); !drawn) return drawn.error();
  target.resolve();
  gl::finish();
  return watch.ms();
}

Result<DrawnFrame> draw_frame(FrameSource& source, FrameTarget& target, ProbeTarget& probe,
                              const WalkFrame& frame, int error_step) {
  const Result<double> ms = time_frame(source, target, frame);
  if (!ms) return ms.error();
  DrawnFrame drawn{*ms, source.stats(), target.read()};
  if (error_step > 0) source.append_errors(error_step, drawn.errors_px);
  probe.begin();
  if (Result<> probed = source.draw_objects(); !probed) return probed.error();
  drawn.objects = probe.read_objects();
  drawn.eye_z = probe.read_eye_z(frame.camera);
  return drawn;
}

}  // namespace rilievo

#include "rilievo/compare/drawn_frame.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

Result<OwnTargets> make_targets(std::span<FrameSource* const> sources, int width, int height,
                                int samples) {
  OwnTargets made;
  if (std::all_of(sources.begin(), sources.end(),
                  [](FrameSource* one) { return one->software_target() != nullptr; }))
    return made;
  Result<FrameTarget> frame = FrameTarget::create(width, height, samples);
  if (!frame) return frame.error();
  Result<ProbeTarget> probe = ProbeTarget::create(width, height);
  if (!probe) return probe.error();
  made.frame = std::move(*frame);
  made.probe = std::move(*probe);
  return made;
}

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
                              const WalkFrame& frame) {
  const Result<double> ms = time_frame(source, targets, frame);
  if (!ms) return ms.error();
  DrawnFrame drawn{*ms, source.stats(), read_frame(source, targets)};
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

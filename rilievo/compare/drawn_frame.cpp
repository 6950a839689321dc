#include "rilievo/compare/drawn_frame.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/frame/gl/opengl_target.h"

namespace rilievo {

Result<DrawTargets> DrawTargets::create(std::span<FrameSource* const> sources, int width,
                                        int height, int samples) {
  DrawTargets made;
  if (std::all_of(sources.begin(), sources.end(),
                  [](FrameSource* one) { return one->software_target() != nullptr; }))
    return made;
  Result<OpenGLTarget> opengl = OpenGLTarget::create(width, height, samples);
  if (!opengl) return opengl.error();
  made.opengl_ = std::make_unique<OpenGLTarget>(std::move(*opengl));
  return made;
}

BackendTarget& DrawTargets::of(const FrameSource& source) const {
  if (source.software_target()) return *software_;
  RILIEVO_EXPECTS(opengl_ != nullptr);
  return *opengl_;
}

Result<double> time_frame(FrameSource& source, BackendTarget& target, const WalkFrame& frame) {
  if (Result<> drawn = target.draw(source, frame.camera, frame.time); !drawn) return drawn.error();
  return target.frame_ms();
}

Result<DrawnFrame> draw_frame(FrameSource& source, BackendTarget& target, const WalkFrame& frame) {
  const Result<double> ms = time_frame(source, target, frame);
  if (!ms) return ms.error();
  DrawnFrame drawn{*ms, source.stats(), target.color()};
  Result<SeenObjects> seen = target.draw_objects(source);
  if (!seen) return seen.error();
  drawn.objects = std::move(seen->objects);
  drawn.eye_z = std::move(seen->eye_z);
  return drawn;
}

}  // namespace rilievo

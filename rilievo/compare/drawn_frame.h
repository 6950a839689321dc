// A source's frame: what it shows, and how long it took to draw.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/frame/software/software_backend_target.h"

namespace rilievo {

// A moment of a walk: the camera and the time of the animation (seconds).
struct WalkFrame {
  Camera camera;
  double time = 0;
};

// The limits of a method's bounds.
struct BoundLimits {
  double error_px = 1, gap_px = 2;
  [[nodiscard]] bool hold(const FrameStats& stats) const {
    return stats.bound_px.value_or(0) <= error_px && stats.gap_px <= gap_px;
  }
};

// A frame that was drawn and read back.
struct DrawnFrame {
  double frame_ms = 0;  // wall-clock time from begin() until all drawing is complete
  FrameStats stats;
  Rgba8Image color;
  Image<std::uint32_t> objects;  // at pixel centres, as eye_z
  Image<float> eye_z;
};

// The targets of frames: OpenGL's, if any source needs it, and memory.
class DrawTargets {
 public:
  // For sources that draw without OpenGL.
  DrawTargets() = default;
  // For `sources`. Needs a current OpenGL context unless all draw without.
  [[nodiscard]] static Result<DrawTargets> create(std::span<FrameSource* const> sources, int width,
                                                  int height, int samples);

  // The target of a source that draws as one of those does.
  [[nodiscard]] BackendTarget& of(const FrameSource& source) const;
  [[nodiscard]] bool with_opengl() const { return opengl_ != nullptr; }

 private:
  std::unique_ptr<BackendTarget> software_ = std::make_unique<SoftwareBackendTarget>();
  std::unique_ptr<BackendTarget> opengl_;  // null: no source needs it
};

// Draws and times the frame, without reading it back. Needs a current OpenGL context unless the
// source draws without.
[[nodiscard]] Result<double> time_frame(FrameSource& source, BackendTarget& target,
                                        const WalkFrame& frame);
[[nodiscard]] inline Result<double> time_frame(FrameSource& source, const DrawTargets& targets,
                                               const WalkFrame& frame) {
  return time_frame(source, targets.of(source), frame);
}

// Draws and times the frame, then reads back colours, objects and depths.
[[nodiscard]] Result<DrawnFrame> draw_frame(FrameSource& source, BackendTarget& target,
                                            const WalkFrame& frame);
[[nodiscard]] inline Result<DrawnFrame> draw_frame(FrameSource& source, const DrawTargets& targets,
                                                   const WalkFrame& frame) {
  return draw_frame(source, targets.of(source), frame);
}

}  // namespace rilievo

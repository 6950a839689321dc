// What does a source's frame show, and how long did it take to draw?
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {

// A moment of a walk: the camera and the time of the animation (seconds).
struct WalkFrame {
  Camera camera;
  double time = 0;
};

// What a method's bounds are held against.
struct BoundLimits {
  double error_px = 1, gap_px = 2;
  [[nodiscard]] bool hold(const FrameStats& stats) const {
    return stats.bound_px <= error_px && stats.gap_px <= gap_px;
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

// Where sources that draw with OpenGL draw. Sources with a software_target() need none.
struct DrawTargets {
  FrameTarget* frame = nullptr;
  ProbeTarget* probe = nullptr;
};

// What OpenGL draws into, if any source needs it.
struct OwnTargets {
  std::optional<FrameTarget> frame;
  std::optional<ProbeTarget> probe;

  [[nodiscard]] DrawTargets targets() {
    return {frame ? &*frame : nullptr, probe ? &*probe : nullptr};
  }
};

// Makes the targets for `sources`. Needs a current OpenGL context unless all draw without.
[[nodiscard]] Result<OwnTargets> make_targets(std::span<FrameSource* const> sources, int width,
                                              int height, int samples);

// Draws and times the frame, without reading it back. Needs a current OpenGL context unless the
// source draws without.
[[nodiscard]] Result<double> time_frame(FrameSource& source, const DrawTargets& targets,
                                        const WalkFrame& frame);
[[nodiscard]] inline Result<double> time_frame(FrameSource& source, FrameTarget& target,
                                               const WalkFrame& frame) {
  return time_frame(source, DrawTargets{&target, nullptr}, frame);
}

// The last frame that was drawn into `targets`.
[[nodiscard]] Rgba8Image read_frame(const FrameSource& source, const DrawTargets& targets);

// Draws and times the frame, then reads back colours, objects and depths.
[[nodiscard]] Result<DrawnFrame> draw_frame(FrameSource& source, const DrawTargets& targets,
                                            const WalkFrame& frame);

}  // namespace rilievo

// What does a source's frame show, and how long did it take to draw?
#pragma once

#include <cstdint>
#include <vector>

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

// A frame that was drawn and read back.
struct DrawnFrame {
  double frame_ms = 0;  // wall-clock time from begin() until all drawing is complete
  FrameStats stats;
  Rgba8Image color;
  Image<std::uint32_t> objects;  // at pixel centres, as eye_z
  Image<float> eye_z;
  std::vector<float> errors_px;  // of samples of the pictures drawn
};

// Where sources that draw with OpenGL draw. Sources with a software_target() need none.
struct DrawTargets {
  FrameTarget* frame = nullptr;
  ProbeTarget* probe = nullptr;
};

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

// Draws and times the frame, then reads back colours, objects and depths, and measures the error of
// every `error_step`-th texel in x and y unless that is 0.
[[nodiscard]] Result<DrawnFrame> draw_frame(FrameSource& source, const DrawTargets& targets,
                                            const WalkFrame& frame, int error_step);

}  // namespace rilievo

// One frame as a source drew it: how long that took, and what it shows.
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

// Where the eye is, and the moment of the animation.
struct WalkFrame {
  Camera camera;
  double time = 0;
};

struct DrawnFrame {
  double frame_ms = 0;  // wall clock, from begin() until all drawing is done
  FrameStats stats;
  Rgba8Image color;
  Image<std::uint32_t> objects;  // at pixel centres; so is eye_z
  Image<float> eye_z;
  std::vector<float> errors_px;  // of samples of the pictures drawn
};

// Draws and times the frame, without reading it back. Needs a current OpenGL context.
[[nodiscard]] Result<double> time_frame(FrameSource& source, FrameTarget& target,
                                        const WalkFrame& frame);

// The same, then colours, objects and depths; and the error of every `error_step`-th texel in x and
// y, if that is not 0.
[[nodiscard]] Result<DrawnFrame> draw_frame(FrameSource& source, FrameTarget& target,
                                            ProbeTarget& probe, const WalkFrame& frame,
                                            int error_step);

}  // namespace rilievo

// Frames within a host program's own frame, whatever its depths: reversed, in [0, 1], linear
// colours.
//
// Where the host's window depths are the camera's, as OpenGL's and [0, 1]'s are, frames are drawn
// straight into its framebuffer. Otherwise they are drawn apart, with as many samples, and then
// presented with the host's depths (present_pass.h): one more pass over the frame, in which a
// pixel's samples share a colour and the nearest depth. Leaves the OpenGL state as it was.
#pragma once

#include <memory>

#include "rilievo/frame/camera_from.h"
#include "rilievo/frame/frame_source.h"

namespace rilievo {

// The host's framebuffer.
struct HostOptions {
  int samples = 4;      // of a pixel: 1 or as many as the driver offers
  bool linear = false;  // it takes linear colours, for HDR: what is drawn is converted from sRGB
};

// Draws a source's frames for a host.
class HostFrames {
 public:
  // `frames` draw with OpenGL, or are presented by it, and must outlive the object. Needs a current
  // OpenGL context; fails where the driver does.
  [[nodiscard]] static Result<std::unique_ptr<HostFrames>> create(FrameSource& frames,
                                                                  const HostOptions& options = {});
  ~HostFrames();

  // Draws the frame at `time` (seconds) into the bound framebuffer and viewport, whose size is the
  // camera's, into the host's z-buffer. Fails where the source does.
  Result<> draw(const HostCamera& camera, double time);

 private:
  struct Target;
  HostFrames(FrameSource& frames, const HostOptions& options);

  FrameSource& frames_;
  HostOptions options_;
  std::unique_ptr<Target> target_;
};

}  // namespace rilievo

// A target for frames that are read back, made by a backend: Backend::make_target().
//
//   target->draw(*frames, camera, time);
//   save_png("frame.png", target->color());                       // as a screen shows it
//   save_pictures("frame.exr", {{read_picture(*target, camera)}});   // linear light, with depths
//
// A frame has 8 bits a colour whoever draws it, since pictures do: linear colours are those, in [0,
// 1]. Not for a host's own framebuffer: HostFrames (frame/gl/host_frames.h) is.
#pragma once

#include <cstdint>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/image.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_source.h"

namespace rilievo {

// Identifiers and depths at the centres of a frame's pixels.
struct SeenObjects {
  Image<std::uint32_t> objects;  // identifiers; kNoObject where nothing is
  Image<float> eye_z;            // kNoDepth where nothing is
};

// A frame that can be read.
class BackendTarget {
 public:
  virtual ~BackendTarget() = default;

  // Draws a frame of `source`, which is of the backend, and waits until it is done. Requires a
  // camera of the target's size. Fails where the source does.
  virtual Result<> draw(FrameSource& source, const Camera& camera, double time) = 0;
  // The colours of the last draw(), whose source must be alive: sRGB, row 0 on top.
  [[nodiscard]] virtual Rgba8Image color() const = 0;
  // The distance of a sample of each pixel from the eye's plane, metres, rows as color(); kNoDepth
  // where nothing is, as in the sky.
  [[nodiscard]] virtual Image<float> eye_z() const = 0;
  // Milliseconds by the clock that the last draw() took, until all was done.
  [[nodiscard]] double frame_ms() const { return frame_ms_; }
  // Draws the same frame again as identifiers, with `source` that drew it. Fails where it does.
  [[nodiscard]] virtual Result<SeenObjects> draw_objects(FrameSource& source) = 0;

 protected:
  double frame_ms_ = 0;
};

// The frame that the last draw() drew with `camera`, as a picture: linear colours and eye_z.
[[nodiscard]] DepthImage read_picture(const BackendTarget& target, const Camera& camera);

}  // namespace rilievo

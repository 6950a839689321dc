// A source of a scene's frames: polygons, pictures, a cache, a stored representation.
//
// A frame is target.begin(); source.draw(...); target.resolve(). Its cost includes all three.
#pragma once

#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_content.h"

namespace rilievo {

class SoftwareTarget;

// Draws frames.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Draws the scene as seen by `camera` at `time` (seconds), with the sky, into the backend's
  // current target, whose colours are sRGB-encoded. May capture pictures first.
  virtual Result<> draw(const Camera& camera, double time) = 0;

  // Draws the object identifiers of the last frame into the current ProbeTarget, without the sky.
  // Captures and chooses nothing, so that it shows exactly what the frame shows.
  virtual Result<> draw_objects() = 0;

  // The target of the last frame, if the source draws without OpenGL: it has its own, and does not
  // use the backend's current one. Null: it draws with OpenGL.
  [[nodiscard]] virtual const SoftwareTarget* software_target() const { return nullptr; }

  // Statistics of the last draw().
  [[nodiscard]] virtual const FrameStats& stats() const = 0;

  // The pictures from which the last frame was drawn, named after what they show.
  [[nodiscard]] virtual std::vector<DepthImage> read_pictures() const { return {}; }
};

}  // namespace rilievo

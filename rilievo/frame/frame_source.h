// Something that can draw a scene's frames: directly, from pictures, from a cache ...
//
// A frame is target.begin(); source.draw(...); target.resolve(). All of it is what a frame costs.
#pragma once

#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_content.h"

namespace rilievo {

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Draws the scene as seen by `camera` at `time` seconds, sky included, into the backend's current
  // target, whose colours are sRGB-encoded. May capture pictures first.
  virtual Result<> draw(const Camera& camera, double time) = 0;

  // Draws the last frame once more, object identifiers instead of colours, into the current probe
  // (no sky): nothing is captured, nothing is chosen.
  virtual Result<> draw_objects() = 0;

  [[nodiscard]] virtual const FrameStats& stats() const = 0;

  // Appends how far from where they belong the last draw() showed samples, pixels; every `step`-th
  // texel in x and y. Slow; nothing for sources without pictures.
  virtual void append_errors(int /*step*/, std::vector<float>& /*errors_px*/) const {}
  // The pictures that the last draw() was drawn from, named after what they show.
  [[nodiscard]] virtual std::vector<DepthImage> read_pictures() const { return {}; }
};

}  // namespace rilievo

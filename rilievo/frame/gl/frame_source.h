// Something that can draw a scene's frames: directly, from flat impostors, nailboards, a cache ...
//
// A frame is: target.begin(); source.draw(...); target.resolve(). All of it is what a frame costs.
// Needs a current OpenGL context; leaves the OpenGL state of drawing behind (wrap it in a
// gl::StateGuard inside somebody else's frame).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"

namespace rilievo {

// What the last draw() did.
struct FrameFigures {
  int captures = 0;               // pictures captured in this frame
  double capture_ms = 0;          // their share of the frame, wall clock
  std::size_t picture_bytes = 0;  // memory that pictures hold now
  int polygons = 0;               // objects drawn as polygons ...
  int pictures = 0;               // ... as pictures of their own (flat impostors or nailboards) ...
  int layered = 0;                // ... as layered impostors ...
  int hierarchy = 0;              // ... and pictures drawn that show several objects each
  double bound_px = 0;            // largest error bound of the pictures drawn, pixels; 0: not known
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Draws the scene as seen by `camera` at `time` seconds, sky included, into the bound draw
  // framebuffer, whose colours are sRGB-encoded. May capture pictures first.
  virtual Result<> draw(const Camera& camera, double time) = 0;

  // Draws the last frame's decisions once more, object identifiers instead of colours, into the
  // bound probe (no sky): nothing is captured, nothing is decided.
  virtual Result<> draw_objects() = 0;

  [[nodiscard]] virtual FrameFigures figures() const = 0;

  // Appends how far from where they belong the last draw() showed samples of its pictures, pixels;
  // every `step`-th texel in x and y. Slow; nothing for sources without pictures.
  virtual void append_errors(int /*step*/, std::vector<float>& /*errors_px*/) const {}
};

}  // namespace rilievo

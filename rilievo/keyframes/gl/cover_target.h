// The depths of what is drawn over a warped frame, with the samples of the frame.
#pragma once

#include "rilievo/core/result.h"
#include "rilievo/gl/object.h"

namespace rilievo {

// A framebuffer of depths alone. Needs a current OpenGL context.
class CoverTarget {
 public:
  // Fewer samples where the driver has no more for textures. Fails where it makes none.
  [[nodiscard]] static Result<CoverTarget> create(int width, int height, int samples);

  // Binds it as the draw framebuffer and clears it to far depth.
  void begin();
  // window_z: a multisampled texture, the last row first.
  [[nodiscard]] GLuint depth() const { return depth_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int samples() const { return samples_; }

 private:
  int width_ = 0, height_ = 0, samples_ = 1;
  gl::Texture depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace rilievo

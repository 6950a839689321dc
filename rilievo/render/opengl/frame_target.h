// A target for frames without a window: multisampled colour and depth.
//
// The frame holds sRGB-encoded bytes, so that the resolve averages samples as a screen shows them.
// Direct drawing, pictures and captures share this target and are antialiased alike. Needs a
// current OpenGL context.
#pragma once

#include <cstdint>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/gl/object.h"

namespace rilievo {

// A framebuffer for frames.
class FrameTarget {
 public:
  // Creates a target. `samples` is 1, 4 or any other number that the driver offers.
  [[nodiscard]] static Result<FrameTarget> create(int width, int height, int samples);

  // Binds the target as the draw framebuffer and clears it to transparent black and far depth.
  void begin();
  // Averages the samples. This belongs to the cost of a frame.
  void resolve();
  // Reads the resolved frame; row 0 on top.
  [[nodiscard]] Rgba8Image read() const;
  // Reads eye_z of a sample of each pixel, as `camera` drew it; kNoDepth where nothing is.
  [[nodiscard]] Image<float> read_eye_z(const Camera& camera) const;

  [[nodiscard]] GLuint framebuffer() const { return framebuffer_; }
  [[nodiscard]] GLuint resolved_framebuffer() const { return resolved_framebuffer_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int samples() const { return samples_; }

 private:
  int width_ = 0, height_ = 0, samples_ = 1;
  gl::Renderbuffer color_, depth_;
  gl::Texture resolved_;
  gl::Framebuffer framebuffer_, resolved_framebuffer_;
};

// A framebuffer for measures: the object identifier and the depth at each pixel's centre.
class ProbeTarget {
 public:
  // Creates a target of this size.
  [[nodiscard]] static Result<ProbeTarget> create(int width, int height);

  // Binds the target as the draw framebuffer and clears it to kNoObject and far depth (near depth
  // for cameras that keep the farthest sample).
  void begin(bool keeps_farthest = false);
  // Reads the identifiers.
  [[nodiscard]] Image<std::uint32_t> read_objects() const;
  // Reads eye_z; kNoDepth where nothing was drawn since begin().
  [[nodiscard]] Image<float> read_eye_z(const Camera& camera) const;

  [[nodiscard]] GLuint framebuffer() const { return framebuffer_; }

 private:
  int width_ = 0, height_ = 0;
  bool keeps_farthest_ = false;
  gl::Texture object_, depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace rilievo

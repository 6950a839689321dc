// Where frames are drawn: colour and depth, multisampled, without a window.
//
// The frame holds sRGB-encoded bytes (the frame is the edge at which colour leaves linear light),
// so that the resolve of the samples averages what a screen shows; direct drawing, pictures and
// captures share this, so that all are antialiased alike. Needs a current OpenGL context.
#pragma once

#include <cstdint>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/gl/object.h"

namespace rilievo {

class FrameTarget {
 public:
  // `samples` is 1 or 4 (or whatever the driver offers).
  [[nodiscard]] static Result<FrameTarget> create(int width, int height, int samples);

  // Makes this the draw framebuffer and clears it to transparent black, far depth.
  void begin();
  // Averages the samples. Part of a frame's cost.
  void resolve();
  // The resolved frame; row 0 on top.
  [[nodiscard]] Rgba8Image read() const;

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

// What the measures compare: which object each pixel shows, and how far away, one sample at each
// pixel's centre.
class ProbeTarget {
 public:
  [[nodiscard]] static Result<ProbeTarget> create(int width, int height);

  // Makes this the draw framebuffer and clears it to kNoObject and to the depth that everything
  // beats: far, or near for cameras that keep the farthest sample.
  void begin(bool keeps_farthest = false);
  [[nodiscard]] Image<std::uint32_t> read_objects() const;
  // eye_z of every pixel, kNoDepth where nothing was drawn since begin().
  [[nodiscard]] Image<float> read_eye_z(const Camera& camera) const;

  [[nodiscard]] GLuint framebuffer() const { return framebuffer_; }

 private:
  int width_ = 0, height_ = 0;
  bool keeps_farthest_ = false;
  gl::Texture object_, depth_;
  gl::Framebuffer framebuffer_;
};

}  // namespace rilievo

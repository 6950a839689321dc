// Draws a whole frame that is in textures into the bound framebuffer, with its depths.
//
// Any perspective projection's window depth is an affine function of 1 / eye_z, and so of any
// other's: two numbers convert between all conventions, reversed ones included.
#pragma once

#include "rilievo/core/result.h"
#include "rilievo/gl/object.h"

namespace rilievo {

// The window depth is offset + scale times what the depth texture holds.
struct DepthMap {
  float offset = 0, scale = 1;
  bool reversed = false;  // nearer is larger
};

// A frame in textures.
struct PresentedTextures {
  GLuint color = 0;        // RGBA8, sRGB-encoded, premultiplied by the share of covered samples
  GLuint objects = 0;      // R32UI, instead of colours
  GLuint depth = 0;        // R32F or a depth texture
  int depth_samples = 1;   // more: a multisampled texture, of which the nearest sample counts
  bool top_first = false;  // row 0 is the top row
};

// The shaders. Needs a current OpenGL context.
class PresentPass {
 public:
  // Fails where the driver does.
  [[nodiscard]] static Result<PresentPass> create();

  // Draws colours over the viewport, with blending off and the depth test on. `samples` are the
  // framebuffer's, of which a partly covered pixel writes a share. `linear`: writes linear colours
  // instead of sRGB-encoded ones.
  void draw_color(const PresentedTextures& frame, const DepthMap& depth, int samples,
                  bool linear = false);
  // Draws identifiers; pixels without an object are left.
  void draw_objects(const PresentedTextures& frame, const DepthMap& depth);

 private:
  void draw(const PresentedTextures& frame, const DepthMap& depth);

  gl::Program colors_, multisampled_colors_, objects_;
  gl::VertexArray no_vertices_;
};

}  // namespace rilievo

// Warps keyframes with OpenGL: as warp_keyframes() does, in the same two passes.
//
// Forward in depth by a compute shader, one invocation for each texel, whose square keeps the
// nearest depth at each pixel; backward in colour by a fragment shader. (A mesh of the texels, cut
// at silhouettes, would be two triangles for each texel, most of them smaller than a pixel, and
// lack half a texel of each surface where it is cut: docs/keyframes.md has the times.) Where a
// driver contracts products and sums, a pixel may differ from the processors'.
//
// Needs a current OpenGL context; changes its state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/image.h"
#include "rilievo/gl/object.h"
#include "rilievo/keyframes/filled_hole.h"
#include "rilievo/keyframes/gl/stored_keyframes.h"
#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// What will be drawn over a warped frame, as OpenGL drew it.
struct WarpCoverTexture {
  GLuint window_z = 0;  // multisampled, of the frame's size
  int samples = 1;
  float nearest = 0;  // as WarpCover's
};

// Warps frames, and shows them.
class KeyframeWarper {
 public:
  // Compiles the shaders.
  [[nodiscard]] static Result<KeyframeWarper> create();

  // As warp_keyframes(). Of more than three keyframes the last spare ones are left out. Reads the
  // frame back into `out`. Fails where the driver does.
  Result<> warp(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                const WarpCoverTexture* cover, bool leaves_sky, WarpedFrame& out);

  // Of the last frame: what its holes show.
  void fill(std::span<const FilledHole> holes);
  // Draws it into the bound framebuffer, with its depth: the surfaces that it shows.
  void show(const Camera& frame);
  // Draws its sky, where nothing lies before it, over another one: that of keyframes whose source
  // has one of its own.
  void show_sky(const Camera& frame);
  // Draws identifiers with their depth, 1 / eye_z, of a frame whose first row is at the top.
  void show_objects(const Camera& frame, const Image<std::uint32_t>& objects,
                    const Image<float>& inverse_z);

  // Makes the textures of frames of this size. Fails where the driver does.
  Result<> resize(int width, int height);

  // How many bytes of keyframes the last frame copied to the GPU.
  [[nodiscard]] std::size_t uploaded() const { return stored_.uploaded(); }

 private:
  void upload_sources(const Camera& frame, bool leaves_sky);
  void begin_pass(const gl::Program& program) const;
  void read_back(WarpedFrame& out) const;
  void draw_over(const Camera& frame, const gl::Program& program, GLuint contents, GLuint depths,
                 bool sky);

  gl::Program splat_, lookup_, fill_, show_, show_objects_;
  gl::VertexArray no_vertices_;
  StoredKeyframes stored_;
  int width_ = 0, height_ = 0;
  gl::Buffer depths_;  // 1 / eye_z as bits, of rows -1 to height
  gl::Texture color_, inverse_z_, objects_, object_depths_;
  gl::Framebuffer framebuffer_;
  gl::StreamBuffer stream_, uniforms_;
  std::vector<WarpSource> sources_;
  std::vector<std::uint32_t> words_;
  std::vector<std::uint8_t> plain_sky_;
};

}  // namespace rilievo

// How are layered impostors drawn by OpenGL, with the depth of what they show (S2.3)?
//
// In two ways (draw_options.h). Both are opaque and mix with everything else in the z-buffer. Of
// slices only the edges of quads are antialiased. Of surfaces, in frames of four samples a pixel,
// silhouettes are: where the ray of a pixel's centre passes beside one (silhouette_band.h), or what
// it meets ends there, the ray of each sample is marched.
//
// Needs a current OpenGL context; draws into the bound framebuffer and viewport.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/layered_impostor/gl/layered_pictures.h"
#include "rilievo/layered_impostor/gl/layered_shaders.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {

// A placed impostor.
struct LayeredInstance {
  // Placement relative to the world at capture: a rigid motion, or a uniform scale.
  glm::dmat4 world_from_impostor{1.0};
  // The identifier that draw_objects writes if the pictures show only one object.
  std::uint32_t object = 1;
};

// The programs and buffers that draw layered impostors.
class LayeredDrawer {
 public:
  // Compiles the shaders.
  [[nodiscard]] static Result<LayeredDrawer> create();

  // Draws sRGB-encoded colours. `frame` is a perspective camera.
  void draw(LayeredPictures& pictures, const Camera& frame,
            std::span<const LayeredInstance> instances, const LayeredOptions& options = {});
  // Draws object identifiers into a ProbeTarget.
  void draw_objects(LayeredPictures& pictures, const Camera& frame,
                    std::span<const LayeredInstance> instances, const LayeredOptions& options = {});

  // Draws the edges of the impostors' boxes with depth test (S1.8).
  void draw_outlines(const LayeredPictures& pictures, const Camera& frame,
                     std::span<const LayeredInstance> instances);

  // What the last call drew.
  struct Stats {
    int views = 0;           // pictures bound, over all instances
    std::size_t slices = 0;  // of all views
    std::size_t quads = 0;   // that show them
    double texels = 0;       // in these
  };
  [[nodiscard]] const Stats& stats() const { return stats_; }

 private:
  void draw_surfaces(LayeredPictures& pictures, const Camera& frame,
                     std::span<const LayeredInstance> instances, const LayeredOptions& options,
                     shader::LayeredOutput output);
  void draw_slices(LayeredPictures& pictures, const Camera& frame,
                   std::span<const LayeredInstance> instances, const LayeredOptions& options,
                   shader::LayeredOutput output);

  gl::Program surface_programs_[2], slice_programs_[2];  // by output
  gl::Program box_program_;
  gl::VertexArray no_attributes_, slice_attributes_;
  gl::StreamBuffer view_buffer_, instance_buffer_;
  gl::Buffer slice_buffer_;
  std::size_t slice_capacity_ = 0;
  Stats stats_;
  // Kept between calls, so that drawing does not allocate.
  std::vector<shader::LayeredView> views_;
  std::vector<shader::LayeredInstanceBlock> blocks_;
  std::vector<shader::LayeredSlice> slices_;
};

}  // namespace rilievo

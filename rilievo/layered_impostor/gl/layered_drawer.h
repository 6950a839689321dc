// Draws layered impostors, in two ways (draw_options.h), with the depth of what they show (S2.3).
//
// Both are opaque and mix with whatever else is in the z-buffer. No antialiasing but at the edges
// of the quads and boxes: a pixel's samples are all of the impostor's, or none.
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

struct LayeredInstance {
  // The rigid motion, or uniform scale, from the world in which the pictures were taken.
  glm::dmat4 world_from_impostor{1.0};
  // What a probe sees, if the pictures show but one object.
  std::uint32_t object = 1;
};

class LayeredDrawer {
 public:
  [[nodiscard]] static Result<LayeredDrawer> create();

  // Colours, sRGB-encoded. `frame` is a perspective camera.
  void draw(LayeredPictures& pictures, const Camera& frame,
            std::span<const LayeredInstance> instances, const LayeredOptions& options = {});
  // Object identifiers, for probes.
  void draw_objects(LayeredPictures& pictures, const Camera& frame,
                    std::span<const LayeredInstance> instances, const LayeredOptions& options = {});

  // The edges of the boxes around impostors, hidden behind what has been drawn before (S1.8).
  void draw_outlines(const LayeredPictures& pictures, const Camera& frame,
                     std::span<const LayeredInstance> instances);

  // What the last call drew.
  struct Figures {
    int views = 0;           // pictures bound, over all instances
    std::size_t slices = 0;  // of all views
    std::size_t quads = 0;   // that show them
    double texels = 0;       // in these
  };
  [[nodiscard]] const Figures& figures() const { return figures_; }

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
  Figures figures_;
  // Kept between calls, so that drawing does not allocate.
  std::vector<shader::LayeredView> views_;
  std::vector<shader::LayeredInstanceBlock> blocks_;
  std::vector<shader::LayeredSlice> slices_;
  std::vector<SliceDraw> chosen_;
};

}  // namespace rilievo

// How are thousands of nailboards drawn in one draw call, with the depth of what they show?
//
// Front to back, with exact or linear depth (S1.2, S1.3), or flat, as the baseline (S1.6). Cells
// that are empty or hidden by other nailboards are not drawn (visible_cells.h).
//
// Edges: a texel's alpha is the share of its samples that the object covered at capture. It is
// interpolated between texels and becomes a coverage mask (alpha to coverage). In a frame with n
// samples per pixel, the silhouette has n + 1 steps, whatever the drawing order, and each sample is
// still either drawn or not, as the z-buffer requires. In a frame with one sample per pixel, the
// edge lies where alpha is one half.
//
// Needs a current OpenGL context; draws into the bound framebuffer and viewport.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/nailboard/gl/nailboard_atlas.h"
#include "rilievo/nailboard/gl/nailboard_shaders.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/sample_rounding.h"
#include "rilievo/nailboard/visible_cells.h"

namespace rilievo {

// A picture of the atlas, placed.
struct NailboardInstance {
  AtlasSlot slot;
  PictureGeometry geometry;
  // The rigid motion of the object since the capture.
  glm::dmat4 world_now_from_capture{1.0};
  // The object identifier to write; kNoObject: those captured with the picture.
  std::uint32_t object = kNoObject;
  // The cross-fade range: drawn only at pixels whose hash (shader::kPixelHash) lies in
  // [share_from, share_to).
  float share_from = 0, share_to = 1;
  // The index of the instance that is drawn at all other pixels, if there is one.
  std::optional<std::uint32_t> partner;
};

// The programs and buffers that draw nailboards.
class NailboardDrawer {
 public:
  // Compiles the shaders.
  [[nodiscard]] static Result<NailboardDrawer> create(SampleRounding rounding = SampleRounding::up);

  // Draws sRGB-encoded colours.
  void draw(NailboardAtlas& atlas, const Camera& frame, DepthMode mode,
            std::span<const NailboardInstance> instances);
  // Draws object identifiers into a ProbeTarget.
  void draw_objects(NailboardAtlas& atlas, const Camera& frame, DepthMode mode,
                    std::span<const NailboardInstance> instances);
  // Draws the polygons' outlines with depth test (S1.8).
  void draw_outlines(const Camera& frame, std::span<const NailboardInstance> instances);

 private:
  // As the vertex shader reads it.
  struct Instance {
    glm::vec4 origin_layer, u_axis_slot_x, v_axis_slot_y, eye_slot_width, forward_slot_height,
        depths, share, texel_from_raster[3];
  };
  void place(const Camera& frame, std::span<const NailboardInstance> instances);
  void upload();
  void find_cells(NailboardAtlas& atlas, const Camera& frame, DepthMode mode,
                  std::span<const NailboardInstance> instances);
  void draw_cells(const NailboardAtlas& atlas, DepthMode mode, shader::NailboardOutput output,
                  std::size_t first, std::size_t count);

  SampleRounding rounding_ = SampleRounding::up;
  gl::Program programs_[3][3];  // by DepthMode and output
  gl::Program outline_;
  gl::VertexArray vertex_array_;
  gl::StreamBuffer instance_buffer_, cell_buffer_;
  gl::Buffer index_buffer_;
  std::size_t index_capacity_ = 0;  // rectangles
  glm::mat4 clip_from_relative_{1.0f};
  struct Key {
    float distance;
    std::uint32_t index;
  };
  std::vector<Key> order_;           // front to back
  std::vector<std::uint32_t> rank_;  // in it, by instance
  std::vector<Instance> staging_;
  std::vector<PlacedPolygon> standing_;
  VisibleCells visible_;
  glm::vec2 frame_size_{1.0f};  // pixels
};

}  // namespace rilievo

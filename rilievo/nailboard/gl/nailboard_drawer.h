// Draws thousands of nailboards in one draw call, front to back, with the depth of what they show
// (S1.2, S1.3), or flat, as the thing to beat (S1.6). Cells of them that are empty, or hidden by
// other nailboards, are left out (visible_cells.h).
//
// Edges: a texel's alpha is the share of its samples that the object covered at capture. It is
// interpolated between texels and becomes a coverage mask (alpha to coverage), so that in a frame
// of n samples a pixel the silhouette takes n + 1 steps, whatever the order of drawing; each sample
// is still either drawn or not, as the z-buffer needs it. In a frame of one sample the edge is
// where alpha passes one half.
//
// Needs a current OpenGL context; draws into the bound framebuffer and viewport.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/nailboard/gl/nailboard_shaders.h"
#include "rilievo/nailboard/gl/picture_atlas.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/visible_cells.h"

namespace rilievo {

struct NailboardInstance {
  AtlasSlot slot;
  PictureGeometry geometry;
  // The rigid motion of the object since the capture; identity if it stood still.
  glm::dmat4 world_now_from_capture{1.0};
  // What the probe sees: this object, or, if kNoObject, the identifiers captured with the picture.
  std::uint32_t object = kNoObject;
  // Drawn only where the pixel's hash is in [from, to): what fades in or out (shader::kPixelHash).
  float share_from = 0, share_to = 1;
  // Index of the instance of which all other pixels are drawn, if there is one.
  std::optional<std::uint32_t> partner;
};

class NailboardDrawer {
 public:
  [[nodiscard]] static Result<NailboardDrawer> create();

  // Colours, sRGB-encoded.
  void draw(PictureAtlas& atlas, const Camera& frame, DepthMode mode,
            std::span<const NailboardInstance> instances);
  // Object identifiers, for probes.
  void draw_objects(PictureAtlas& atlas, const Camera& frame, DepthMode mode,
                    std::span<const NailboardInstance> instances);
  // The polygons' outlines, hidden where they lie behind what has been drawn (S1.8).
  void draw_outlines(const Camera& frame, std::span<const NailboardInstance> instances);

 private:
  // As the vertex shader reads it.
  struct Instance {
    glm::vec4 origin_layer, u_axis_slot_x, v_axis_slot_y, eye_slot_width, forward_slot_height,
        depths, share, texel_from_raster[3];
  };
  void place(const Camera& frame, std::span<const NailboardInstance> instances);
  void upload();
  void find_cells(PictureAtlas& atlas, const Camera& frame, DepthMode mode,
                  std::span<const NailboardInstance> instances);
  void draw_cells(const PictureAtlas& atlas, DepthMode mode, shader::NailboardOutput output,
                  std::size_t first, std::size_t count);

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
  std::vector<StandingPicture> standing_;
  VisibleCells visible_;
  glm::vec2 frame_size_{1.0f};  // pixels
};

}  // namespace rilievo

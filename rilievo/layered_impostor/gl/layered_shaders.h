// The shaders that draw layered impostors, and what they read.
//
// Positions are local: axes of the impostor's own world, origin at the eye. Raster positions are a
// picture's, y down; textures are fetched by them.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/gl/object.h"

namespace rilievo::shader {

inline constexpr int kMaxWalkedViews = 6;
// Impostors in one draw call of the surface program, whose blocks have room for so many.
inline constexpr int kMaxInstances = 16;

// One picture as seen by one instance (std140, std430). Homogeneous raster position of a local
// point P: (u w, v w, w) = (dot(u_row, (P, 1)), ...), w = eye_z; and back: P = apex + (base + u du
// + v dv) / q.
struct LayeredView {
  glm::vec4 u_row, v_row, w_row;
  glm::vec4 apex;    // w: +1 ordinary, -1 back-perspective
  glm::vec4 base;    // w: layer of the texture arrays
  glm::vec4 du, dv;  // w: width, height in texels
  glm::vec4 depths;  // z_near, z_far; 1 if the picture is complete, else 0
};

// One impostor to draw by walking (std140).
struct LayeredInstanceBlock {
  glm::mat4 clip_from_local;
  glm::vec4 box_min, box_max;
  glm::vec4 weights[2];  // of the first six views
  glm::ivec4 views;      // first, count, how many have weight; object identifier
};

// One slice to draw (vertex attributes).
struct LayeredSlice {
  glm::vec4 rect;    // x0 y0 x1 y1
  glm::vec4 depths;  // eye_z; front, back in the units of the interval texture; -
  glm::vec4 share;   // of the pixels [x, y); index of the view; identifier's bits
};

enum class LayeredOutput { color, objects };

[[nodiscard]] Result<gl::Program> make_surface_program(LayeredOutput output);
[[nodiscard]] Result<gl::Program> make_slice_program(LayeredOutput output);
// The 12 edges of a box, 24 vertices. Uniforms: 0 clip_from_local, 1 and 2 the box.
[[nodiscard]] Result<gl::Program> make_box_program();

}  // namespace rilievo::shader

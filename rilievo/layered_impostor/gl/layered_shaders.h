// Which shaders draw layered impostors, and what do they read?
//
// Positions are local: world axes of the impostor, origin at the eye. Raster positions are a
// picture's, y down, and index its textures.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/gl/object.h"
#include "rilievo/layered_impostor/draw_options.h"

namespace rilievo::shader {

// The largest number of pictures of which a pixel chooses those that it looks up.
inline constexpr int kMaxViewsAtHand = kMaxViewsAsked + kSpareViews;
// The largest number of impostors in one draw call of the surface program, the size of its blocks.
inline constexpr int kMaxInstances = 12;

// A picture as seen by an instance (std140, std430). The homogeneous raster position of a local
// point P is (u w, v w, w) = (dot(u_row, (P, 1)), ...), with w = eye_z; the inverse is P = apex +
// (base + u du + v dv) / q.
struct LayeredView {
  glm::vec4 u_row, v_row, w_row;
  glm::vec4 apex;    // w: +1 ordinary, -1 back-perspective
  glm::vec4 base;    // w: layer of the texture arrays
  glm::vec4 du, dv;  // w: width, height in texels
  glm::vec4 depths;  // z_near, z_far; 1 if the picture is complete, 1 if it sees through, else 0
};

// An impostor drawn by ray marching (std140).
struct LayeredInstanceBlock {
  glm::mat4 clip_from_local;
  glm::vec4 box_min, box_max;  // w of box_min: how many views a pixel looks up
  glm::vec4 weights[3];
  glm::ivec4 views;  // first, count, how many have weight; object identifier
};

// A slice to draw (vertex attributes).
struct LayeredSlice {
  glm::vec4 rect;    // x0 y0 x1 y1
  glm::vec4 depths;  // eye_z; front, back in the units of the interval texture; -
  glm::vec4 share;   // cross-fade range [x, y); index of the view; identifier's bits
};

// What a program writes.
enum class LayeredOutput { color, objects };

// Compile the programs of the two ways of drawing.
[[nodiscard]] Result<gl::Program> make_surface_program(LayeredOutput output);
[[nodiscard]] Result<gl::Program> make_slice_program(LayeredOutput output);
// Compiles the program of the 12 edges of a box, 24 vertices. Uniforms: 0 clip_from_local, 1 and 2
// the box.
[[nodiscard]] Result<gl::Program> make_box_program();

}  // namespace rilievo::shader

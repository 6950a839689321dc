// What is a triangle's surface like where a ray of a picture meets it?
//
// SIMD over rays that meet triangles of one placed mesh: position, normal, and what its material
// and its textures are there. The same bytes for any instruction set. Pure; any thread.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "rilievo/render/shading/surface.h"
#include "rilievo/render/shading/surface_shading.h"

namespace rilievo {

// A structure of arrays; the first `count` entries are to be looked at.
struct TriangleRays {
  static constexpr std::size_t kMaxCount = 64;
  std::size_t count = 0;
  alignas(64) float ray[3][kMaxCount];  // as PictureRays has it, of any length
  // Of each corner, in mesh space.
  alignas(64) float position[3][3][kMaxCount];
  alignas(64) float normal[3][3][kMaxCount];  // only if the mesh has any
  alignas(64) float color[3][3][kMaxCount];
  alignas(64) float uv[2][3][2][kMaxCount];  // of the sets that the material uses; else zeros
};

// Appends what the rays meet; of a ray that passes by, the nearest point of the triangle, nearly.
// Requires room for all in `surfaces`.
void append_surfaces(const TriangleRays& triangles, const PictureRays& rays,
                     const SurfacePlacement& placement, Surfaces& surfaces);

}  // namespace rilievo

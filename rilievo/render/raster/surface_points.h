// What is a triangle's surface like where a ray from the eye meets it?
//
// SIMD over rays that meet triangles of one placed mesh. Positions are relative to the eye, in
// world axes, metres. The same bytes for any instruction set. Pure; any thread.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "rilievo/render/shading/surface_shading.h"

namespace rilievo {

// How the mesh is placed, and what all of it is made of.
struct SurfacePlacement {
  glm::mat4 relative_from_mesh{1.0f};
  glm::mat3 normal_from_mesh{1.0f};  // to any length
  bool has_normals = false, has_colors = false;
  glm::vec3 base_color{1.0f}, emissive{0.0f};
  float roughness = 1, metallic = 0;
  bool unlit = false;
};

// A structure of arrays; the first `count` entries are to be looked at.
struct TriangleRays {
  static constexpr std::size_t kMost = 64;
  std::size_t count = 0;
  alignas(64) float ray[3][kMost];  // from the eye, of any length
  // Of each corner, in mesh space.
  alignas(64) float position[3][3][kMost];
  alignas(64) float normal[3][3][kMost];  // only if the mesh has any
  alignas(64) float color[3][3][kMost];
};

// Appends what the rays meet; of a ray that passes by, the nearest point of the triangle, nearly.
// Requires room for all in `surfaces`.
void append_surfaces(const TriangleRays& rays, const SurfacePlacement& placement,
                     Surfaces& surfaces);

}  // namespace rilievo

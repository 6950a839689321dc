// A triangle's surface where a ray of a picture hits it.
//
// SIMD over rays that hit triangles of one placed mesh: position, normal, and the values of its
// material and textures. The result does not depend on the instruction set. Pure; any thread.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "rilievo/render/shading/surface.h"
#include "rilievo/render/shading/surface_shading.h"

namespace rilievo {

// Rays and the triangles that they hit, as a structure of arrays with `count` valid entries.
struct TriangleRays {
  static constexpr std::size_t kMaxCount = 64;
  static constexpr std::size_t kCapacity = kMaxCount + 16;  // whoever fills it may write past count
  std::size_t count = 0;
  alignas(64) float ray[3][kCapacity];  // as in PictureRays, of any length
  // For each corner, in mesh space:
  alignas(64) float position[3][3][kCapacity];
  alignas(64) float normal[3][3][kCapacity];  // only if the mesh has normals
  alignas(64) float color[3][3][kCapacity];
  alignas(64) float alpha[3][kCapacity];     // of the colours; only if the material blends
  alignas(64) float uv[2][3][2][kCapacity];  // of the sets that the material uses; else zeros
};

// Appends the surfaces at the hits. For a ray that misses its triangle, appends approximately the
// nearest point of the triangle. Requires room for all in `surfaces`.
void append_surfaces(const TriangleRays& triangles, const PictureRays& rays,
                     const SurfacePlacement& placement, Surfaces& surfaces);

}  // namespace rilievo

// How far are the normals that triangles interpolate from where the triangles face?
//
// A flat face between round edges loses its inner vertices when a mesh is simplified, at no
// distance: its corners' normals, which look aside, are then smeared over all of it. That shows as
// much as a surface that bulges. With the angle between where a triangle faces and the mean of its
// vertices' normals, and its size, it bulges by about
//
//   e = angle sqrt(area)
//
// of which the root mean square over all triangles, by area, is a distance.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/scene/scene.h"

namespace rilievo {

// Of triangles of the mesh's vertices; 0 without normals. Mesh space, metres.
[[nodiscard]] double shading_error(const Mesh& mesh, std::span<const std::uint32_t> indices);

}  // namespace rilievo

// How much does each texel of a node count where several nodes show one surface? (S3.7)
//
// Nothing beside a silhouette, where its colour may be mixed and its place is uncertain, and where
// another node would show a seam; from there the weight rises over kFeather texels. Besides, as the
// cosine of the angle between the surface's normal and the line of sight: how well it is seen
// (S3.4, by texels instead of triangles, so that it changes smoothly).
#pragma once

#include <array>
#include <cstdint>

#include "rilievo/core/image.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {

// Texels from a silhouette at which a texel has its full weight. Steps go along rows and columns.
inline constexpr int kFeather = 4;

// Of each texel of each face: 255 for what is seen head on, far from all silhouettes.
[[nodiscard]] std::array<Image<std::uint8_t>, 6> texel_weights(const CubeGrid& grid);

}  // namespace rilievo

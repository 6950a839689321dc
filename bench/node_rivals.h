// Other ways to make a node's mesh, to compare with.
#pragma once

#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo::bench {

// Every face a regular grid, as fine as `triangles` allow; each vertex has the disparity between
// the four texels around it.
[[nodiscard]] NodeMesh grid_mesh(const EnvironmentMap& map, std::size_t triangles);

// Every face a grid with a vertex a texel, simplified by libmeshoptimizer over (x, y, disparity) to
// one error for all faces, such that all have at most `triangles`; faces may part at the cube's
// edges. `weight`: how much a face's width is worth of the largest disparity.
[[nodiscard]] NodeMesh simplified_mesh(const EnvironmentMap& map, std::size_t triangles,
                                       float weight);

}  // namespace rilievo::bench

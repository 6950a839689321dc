// How do six faces' triangulations become one mesh with skins? Internal to triangulate().
#pragma once

#include <array>

#include "rilievo/environment_nodes/face_mesh.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// The mesh of all faces, surfaces and skins. The triangulations must share their points on the
// cube's edges.
[[nodiscard]] NodeMesh assemble_mesh(const CubeGrid& grid,
                                     const std::array<const FaceMesh*, 6>& faces);

}  // namespace rilievo

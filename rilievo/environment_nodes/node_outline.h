// The outline of an environment node: where its six pictures meet (S1.8).
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// Two ends for each line, in the world of the mesh: the edges of its surfaces that lie on the edges
// of the cube of six faces. None in the sky, where a surface is infinitely far.
[[nodiscard]] std::vector<glm::dvec3> node_outline(const NodeMesh& mesh);

}  // namespace rilievo

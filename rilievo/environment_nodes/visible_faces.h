// Which of a node's six sides can an eye see? (S3.5)
//
// A side's triangles lie in a pyramid with its apex at the node. A side is not drawn if its pyramid
// does not intersect the view frustum. Conservative.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// The range of disparities of a side's triangles, skins included.
struct SideReach {
  float least_disparity = 0, most_disparity = 0;
  bool empty = true;
};
// The ranges of all sides.
[[nodiscard]] std::array<SideReach, 6> side_reaches(const NodeMesh& mesh);

// The sides visible to a perspective camera. Its near and far planes are ignored, because nodes are
// drawn from the eye to the sky.
[[nodiscard]] std::array<bool, 6> visible_faces(const NodeMesh& mesh,
                                                const std::array<SideReach, 6>& reaches,
                                                const Camera& frame);

// Clip coordinates of a mesh's (direction, disparity).
[[nodiscard]] glm::dmat4 clip_from_node(const NodeMesh& mesh, const Camera& frame);

}  // namespace rilievo

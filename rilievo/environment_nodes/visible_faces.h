// Which of a node's six sides can an eye see? (S3.5)
//
// A side's triangles lie in a pyramid with its apex at the node; a side whose pyramid the view
// frustum does not meet is not drawn. Errs towards drawing.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// How far the triangles of each side reach, skins included.
struct SideReach {
  float least_disparity = 0, most_disparity = 0;
  bool empty = true;
};
[[nodiscard]] std::array<SideReach, 6> side_reaches(const NodeMesh& mesh);

// Of a perspective camera, without its near and far planes: nodes are drawn from the eye to the
// sky.
[[nodiscard]] std::array<bool, 6> visible_faces(const NodeMesh& mesh,
                                                const std::array<SideReach, 6>& reaches,
                                                const Camera& frame);

// Clip coordinates of a mesh's (direction, disparity).
[[nodiscard]] glm::dmat4 clip_from_node(const NodeMesh& mesh, const Camera& frame);

}  // namespace rilievo

// Which edges of a node's mesh can be silhouettes in a frame?
//
// An edge is a silhouette where one triangle alone has it, or where the eye sees one of its two
// triangles from behind. No eye does so that is nearer to the node than the planes of both.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// An edge from one corner to the other, counter-clockwise around its triangle, whose third corner
// is `inner`; the other triangle's is `outer`, or kNone.
struct MeshEdge {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t from = 0, to = 0, inner = 0, outer = kNone;
  float reach = 0;  // metres: the eyes of which it is no silhouette are nearer to the node
};

// The edges of each face's surfaces, by reach. Not those of surfaces that begin behind a
// silhouette of another: both lie on the same lines of sight of the node, and the eye sees a skin
// beside them. An edge where two faces meet is one face's: it lies on the border of both faces'
// pyramids, and a face whose pyramid reaches into the frame is not left out (visible_faces.h).
[[nodiscard]] std::array<std::vector<MeshEdge>, 6> find_mesh_edges(const NodeMesh& mesh);

}  // namespace rilievo

// What is kept of a node to draw it without OpenGL? Internal to environment_nodes/software.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/environment_nodes/mesh_edges.h"
#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/environment_nodes/visible_faces.h"

namespace rilievo {

// A node's mesh and faces.
struct SoftwareNode {
  NodeMesh mesh;
  std::array<SideReach, 6> reaches;
  std::array<std::vector<MeshEdge>, 6> edges;
  // The faces one after the other, row by row. Colours are sRGB-encoded, with the texel's weight in
  // the highest byte, and faces of `wide` texels a side have a border of one texel from their
  // neighbours. No identifiers if the pictures have none.
  std::vector<std::uint32_t> color, object;
  // 1 / eye_z of the face; 0 the sky, -1 nothing; and one more.
  std::vector<float> disparity;

  [[nodiscard]] glm::dvec3 eye() const { return glm::dvec3(mesh.world_from_node[3]); }
  [[nodiscard]] int wide() const { return mesh.face_size + 2; }
  [[nodiscard]] std::size_t bytes() const;
};

// Requires a valid environment, and a mesh of it.
[[nodiscard]] SoftwareNode make_memory_node(const EnvironmentMap& map, const NodeMesh& mesh);

}  // namespace rilievo

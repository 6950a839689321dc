// What is kept of a node to draw it without OpenGL? Internal to environment_nodes/cpu.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/environment_nodes/visible_faces.h"

namespace rilievo {

// A node's mesh and faces.
struct MemoryNode {
  NodeMesh mesh;
  std::array<SideReach, 6> reaches;
  // The faces, sRGB-encoded, each with a border of one texel from its neighbours.
  std::array<std::vector<std::uint32_t>, 6> color;
  std::array<Image<std::uint32_t>, 6> object;  // empty if the pictures have none

  [[nodiscard]] glm::dvec3 eye() const { return glm::dvec3(mesh.world_from_node[3]); }
  [[nodiscard]] bool has_objects() const { return !object[0].empty(); }
  [[nodiscard]] std::size_t bytes() const;
  // The colour in a direction, in node space, of any length: between four texels, 0 to 255.
  [[nodiscard]] glm::vec3 color_in(const glm::vec3& direction) const;
  // The identifier there.
  [[nodiscard]] std::uint32_t object_in(const glm::vec3& direction) const;
};

// Requires a valid environment, and a mesh of it.
[[nodiscard]] MemoryNode make_memory_node(const EnvironmentMap& map, const NodeMesh& mesh);

}  // namespace rilievo

#include "rilievo/environment_nodes/node_outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace rilievo {
namespace {

// Do both directions lie on one edge of the cube [-1, 1]^3?
bool lie_on_cube_edge(const glm::vec3& a, const glm::vec3& b) {
  int sides = 0;
  for (int k = 0; k < 3; ++k) sides += std::abs(a[k]) == 1 && a[k] == b[k];
  return sides >= 2;
}

}  // namespace

std::vector<glm::dvec3> node_outline(const NodeMesh& mesh) {
  // Both faces beside an edge of the cube have the same vertices there.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t t = 0; t < mesh.surface_triangles(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.indices[3 * t + k], b = mesh.indices[3 * t + (k + 1) % 3];
      const NodeVertex &from = mesh.vertices[a], &to = mesh.vertices[b];
      if (from.disparity > 0 && to.disparity > 0 && lie_on_cube_edge(from.direction, to.direction))
        edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<glm::dvec3> ends;
  ends.reserve(2 * edges.size());
  for (const auto& [a, b] : edges)
    for (const std::uint32_t v : {a, b}) {
      const NodeVertex& vertex = mesh.vertices[v];
      const glm::dvec3 at = glm::dvec3(vertex.direction) / double(vertex.disparity);
      ends.emplace_back(mesh.world_from_node * glm::dvec4(at, 1));
    }
  return ends;
}

}  // namespace rilievo

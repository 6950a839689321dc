#include "rilievo/scene/shading_error.h"

#include <cmath>
#include <glm/glm.hpp>

namespace rilievo {

double shading_error(const Mesh& mesh, std::span<const std::uint32_t> indices) {
  if (mesh.normals.empty()) return 0;
  double squares = 0, areas = 0;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[indices[i]]), b(mesh.positions[indices[i + 1]]),
        c(mesh.positions[indices[i + 2]]);
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double twice = glm::length(across);
    const glm::dvec3 sum = glm::dvec3(mesh.normals[indices[i]]) +
                           glm::dvec3(mesh.normals[indices[i + 1]]) +
                           glm::dvec3(mesh.normals[indices[i + 2]]);
    const double length = glm::length(sum);
    if (twice == 0 || length == 0) continue;
    const double area = twice / 2;
    // Some meshes' triangles wind the other way.
    const double off = glm::acos(glm::min(std::abs(glm::dot(across, sum)) / (twice * length), 1.0));
    squares += area * off * off * area;
    areas += area;
  }
  return areas > 0 ? std::sqrt(squares / areas) : 0;
}

}  // namespace rilievo

#include "rilievo/environment_nodes/node_mesh.h"

#include <cmath>

namespace rilievo {

// Of vertices at direction / disparity, as homogeneous points (direction, disparity): the plane
// through three of them has the normal that is orthogonal to all of them in four dimensions, which
// exists with vertices at infinity, too.
float triangle_quality(const NodeVertex& a, const NodeVertex& b, const NodeVertex& c) {
  const glm::dvec3 da(a.direction), db(b.direction), dc(c.direction);
  const glm::dvec3 normal = double(a.disparity) * glm::cross(db, dc) +
                            double(b.disparity) * glm::cross(dc, da) +
                            double(c.disparity) * glm::cross(da, db);
  const glm::dvec3 middle = da + db + dc;
  const double length = glm::length(normal) * glm::length(middle);
  // What lies infinitely far is seen head on.
  if (!(length > 1e-30)) return a.disparity == 0 && b.disparity == 0 && c.disparity == 0 ? 1 : 0;
  return float(std::abs(glm::dot(normal, middle)) / length);
}

std::size_t bytes(const NodeMesh& mesh) {
  std::size_t sum = mesh.vertices.size() * sizeof(NodeVertex) +
                    mesh.indices.size() * sizeof(std::uint32_t) +
                    mesh.quality.size() * sizeof(float);
  for (const Image<std::uint8_t>& face : mesh.weights) sum += face.texels().size();
  return sum;
}

}  // namespace rilievo

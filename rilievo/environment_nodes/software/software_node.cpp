#include "rilievo/environment_nodes/software/software_node.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/color.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {

// Where a direction meets a face: u to the right and v downwards, each from 0 to 1 within it.
struct FacePoint {
  int face = 0;
  float u = 0, v = 0;
};

FacePoint face_point(const glm::vec3& d) {
  const glm::vec3 a = glm::abs(d);
  const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
  FacePoint point{2 * axis + (d[axis] < 0), 0, 0};
  const FaceAxes& axes = face_axes()[std::size_t(point.face)];
  const float depth = a[axis];
  point.u = 0.5f + 0.5f * glm::dot(d, glm::vec3(axes.right)) / depth;
  point.v = 0.5f - 0.5f * glm::dot(d, glm::vec3(axes.up)) / depth;
  return point;
}

int texel_at(float share, int size) { return std::clamp(int(share * float(size)), 0, size - 1); }

}  // namespace

SoftwareNode make_memory_node(const EnvironmentMap& map, const NodeMesh& mesh) {
  SoftwareNode node;
  node.mesh = mesh;
  node.reaches = side_reaches(mesh);
  node.edges = find_mesh_edges(mesh);
  const int size = mesh.face_size, wide = size + 2;
  std::array<Rgba8Image, 6> faces;
  for (std::size_t f = 0; f < 6; ++f) {
    faces[f] = srgb8_from_linear(map.faces[f].color);
    for (std::size_t i = 0; i < faces[f].texels().size(); ++i)
      faces[f].texels()[i].a = mesh.weights[f].texels()[i];
  }
  const auto word = [](const glm::u8vec4& c) {
    return std::uint32_t(c.r) | std::uint32_t(c.g) << 8 | std::uint32_t(c.b) << 16 |
           std::uint32_t(c.a) << 24;
  };
  node.color.reserve(6 * std::size_t(wide) * std::size_t(wide));
  for (std::size_t f = 0; f < 6; ++f) {
    const FaceAxes& axes = face_axes()[f];
    for (int y = -1; y <= size; ++y)
      for (int x = -1; x <= size; ++x) {
        if (x >= 0 && y >= 0 && x < size && y < size) {
          node.color.push_back(word(faces[f](x, y)));
          continue;
        }
        // What lies beyond the edge is in the neighbour.
        const float u = 2 * (float(x) + 0.5f) / float(size) - 1,
                    v = 1 - 2 * (float(y) + 0.5f) / float(size);
        const FacePoint at = face_point(glm::vec3(axes.forward) + u * glm::vec3(axes.right) +
                                        v * glm::vec3(axes.up));
        node.color.push_back(
            word(faces[std::size_t(at.face)](texel_at(at.u, size), texel_at(at.v, size))));
      }
  }
  node.disparity.reserve(6 * std::size_t(size) * std::size_t(size) + 1);
  for (const DepthImage& face : map.faces) {
    const Image<float> of_face = face_disparity(face);
    node.disparity.insert(node.disparity.end(), of_face.texels().begin(), of_face.texels().end());
  }
  node.disparity.push_back(0);  // they are loaded in pairs
  node.mesh.weights = {};       // they are in the colours
  if (map.faces[0].object.empty()) return node;
  for (const DepthImage& face : map.faces) {
    const std::span<const std::uint32_t> object = face.object.texels();
    if (object.empty())
      node.object.insert(node.object.end(), std::size_t(size) * std::size_t(size), kNoObject);
    else
      node.object.insert(node.object.end(), object.begin(), object.end());
  }
  return node;
}

std::size_t SoftwareNode::bytes() const {
  std::size_t edge_bytes = 0;
  for (const std::vector<MeshEdge>& face : edges) edge_bytes += face.size() * sizeof(MeshEdge);
  return rilievo::bytes(mesh) + edge_bytes + 4 * (color.size() + object.size() + disparity.size());
}

}  // namespace rilievo

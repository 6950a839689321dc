#include "rilievo/environment_nodes/mesh_edges.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <tuple>

namespace rilievo {
namespace {

// An edge as one triangle has it.
struct HalfEdge {
  std::uint32_t low, high, from, to, inner, face;
};

// How far is the plane of a triangle from the node? With corners c / d it is
//
//   |c0 . (c1 x c2)| / |d0 (c1 x c2) + d1 (c2 x c0) + d2 (c0 x c1)|
float plane_distance(const NodeVertex& a, const NodeVertex& b, const NodeVertex& c) {
  const glm::dvec3 p(a.direction), q(b.direction), r(c.direction);
  const glm::dvec3 qr = glm::cross(q, r);
  const double below =
      glm::length(double(a.disparity) * qr + double(b.disparity) * glm::cross(r, p) +
                  double(c.disparity) * glm::cross(p, q));
  return below > 0 ? float(std::abs(glm::dot(p, qr)) / below)
                   : std::numeric_limits<float>::infinity();
}

// The lines of sight of an edge's ends, whichever of them is the first.
using Sight = std::array<float, 6>;
Sight sight_of(const NodeVertex& a, const NodeVertex& b) {
  std::array<float, 3> p{a.direction.x, a.direction.y, a.direction.z},
      q{b.direction.x, b.direction.y, b.direction.z};
  if (q < p) std::swap(p, q);
  return {p[0], p[1], p[2], q[0], q[1], q[2]};
}

// Of borders on the same lines of sight the nearest remains.
void drop_farther_borders(const NodeMesh& mesh, std::vector<MeshEdge>& borders) {
  const auto nearness = [&](const MeshEdge& e) {
    return mesh.vertices[e.from].disparity + mesh.vertices[e.to].disparity;
  };
  const auto sight = [&](const MeshEdge& e) {
    return sight_of(mesh.vertices[e.from], mesh.vertices[e.to]);
  };
  std::sort(borders.begin(), borders.end(), [&](const MeshEdge& a, const MeshEdge& b) {
    const Sight at_a = sight(a), at_b = sight(b);
    return std::tuple(at_a, -nearness(a), a.from) < std::tuple(at_b, -nearness(b), b.from);
  });
  borders.erase(
      std::unique(borders.begin(), borders.end(),
                  [&](const MeshEdge& a, const MeshEdge& b) { return sight(a) == sight(b); }),
      borders.end());
}

}  // namespace

std::array<std::vector<MeshEdge>, 6> find_mesh_edges(const NodeMesh& mesh) {
  std::vector<HalfEdge> halves;
  halves.reserve(3 * mesh.surface_triangles());
  for (std::uint32_t f = 0; f < 6; ++f)
    for (std::uint32_t t = mesh.surfaces[f].first;
         t < mesh.surfaces[f].first + mesh.surfaces[f].count; ++t)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const auto corner = [&](std::uint32_t i) {
          return mesh.indices[3 * std::size_t(t) + (k + i) % 3];
        };
        const std::uint32_t from = corner(0), to = corner(1);
        halves.push_back({std::min(from, to), std::max(from, to), from, to, corner(2), f});
      }
  std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tuple(a.low, a.high, a.face, a.from, a.inner) <
           std::tuple(b.low, b.high, b.face, b.from, b.inner);
  });
  const auto distance = [&](const HalfEdge& e) {
    return plane_distance(mesh.vertices[e.from], mesh.vertices[e.to], mesh.vertices[e.inner]);
  };
  std::array<std::vector<MeshEdge>, 6> edges;
  std::vector<MeshEdge> borders;
  std::vector<std::uint32_t> faces;
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const HalfEdge& one = halves[i];
    MeshEdge edge{one.from, one.to, one.inner, MeshEdge::kNone, 0};
    if (i + 1 < halves.size() && halves[i + 1].low == one.low && halves[i + 1].high == one.high) {
      const HalfEdge& other = halves[++i];
      edge.outer = other.inner;
      edge.reach = std::min(distance(one), distance(other));
      edges[one.face].push_back(edge);
    } else {
      borders.push_back(edge);
    }
  }
  drop_farther_borders(mesh, borders);
  for (const MeshEdge& edge : borders) {
    const glm::vec3 middle = mesh.vertices[edge.from].direction + mesh.vertices[edge.to].direction;
    const glm::vec3 a = glm::abs(middle);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    // The sky has no border of its own.
    if (mesh.vertices[edge.from].disparity > 0 || mesh.vertices[edge.to].disparity > 0)
      edges[std::size_t(2 * axis + (middle[axis] < 0))].push_back(edge);
  }
  for (std::vector<MeshEdge>& face : edges)
    std::sort(face.begin(), face.end(), [](const MeshEdge& a, const MeshEdge& b) {
      return std::tuple(a.reach, a.from, a.to) < std::tuple(b.reach, b.from, b.to);
    });
  return edges;
}

}  // namespace rilievo

// How far are two meshes apart? An upper bound of the Hausdorff distance.
//
// The largest distance of a point of one surface from the nearest point of the other. Any triangle
// of the other surface gives an upper bound of that for a triangle: the distance to one fixed
// triangle is convex, so that no point is farther from it than the farthest corner. What is not
// decided by the nearest triangles of its corners is bisected. Any thread; the same result on each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace rilievo {

// The triangles of a mesh, to find the nearest of a point. At least one.
class TriangleTree {
 public:
  // Three indices a triangle.
  TriangleTree(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices);

  // What nearest() finds.
  struct Nearest {
    std::uint32_t triangle = 0;  // the tree's number
    double square = 0;           // of the distance
  };
  // The nearest triangle, or the one given if none is nearer.
  [[nodiscard]] Nearest nearest(const glm::dvec3& p, std::uint32_t first = 0) const;
  // The square of the distance of a point from one triangle.
  [[nodiscard]] double square_distance(const glm::dvec3& p, std::uint32_t triangle) const;

 private:
  struct Node {
    glm::vec3 min, max;
    std::uint32_t first = 0, count = 0;  // triangles of a leaf; count 0: first is the second child
  };
  std::uint32_t build(std::span<std::uint32_t> order, std::span<const glm::vec3> centers);

  std::vector<Node> nodes_;                      // the first child follows its parent
  std::vector<std::array<glm::vec3, 3>> given_;  // triangles while building
  std::vector<std::array<glm::vec3, 3>> corners_;
};

// Between them is the largest distance.
struct DistanceBounds {
  double lower = 0, upper = 0;
};

// How exact, and for how much work.
struct DistanceOptions {
  // `upper` is above `lower` by at most the larger of this share of it and `slack`, but for `work`.
  double share = 0.05, slack = 0;
  // Of what is bisected, as a multiple of the number of triangles of both surfaces.
  double work = 4;
  // Where the distance is larger, the bounds need not be near each other.
  double too_far = 1e300;
};

// How far are the points of a surface from another one, at most? One direction.
[[nodiscard]] DistanceBounds farthest_from(const TriangleTree& other,
                                           std::span<const glm::vec3> positions,
                                           std::span<const std::uint32_t> indices,
                                           std::size_t other_triangles,
                                           const DistanceOptions& options = {});

}  // namespace rilievo

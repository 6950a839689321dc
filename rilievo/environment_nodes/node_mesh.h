// Which mesh stands for an environment node? (S3.2)
//
// One textured triangle mesh around the point from which the node's six faces were captured. A
// vertex lies at `direction` / `disparity` from the node, in node space. `direction` is a point of
// the cube
// [-1, 1]^3, and `disparity` is 1 / eye_z of a face on which it lies. So the same triangles draw
// the infinitely far sky (disparity 0). Faces share the vertices on the cube's edges, and both
// sides of a silhouette lie on the same lines of sight: seen from the node's own eye the mesh has
// no cracks, and with its skins it is closed.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// A vertex of a surface or a skin.
struct NodeVertex {
  glm::vec3 direction{0, 0, 1};
  float disparity = 0;
  // The direction from which a skin takes its colour: slightly inside the farther of the surfaces
  // that it joins. For vertices of surfaces, `direction` itself.
  glm::vec3 texture{0, 0, 1};
  // 0 at a skin's nearer border, 1 at the farther one: its rate of change over the frame tells how
  // wide the skin is. kAlways: always drawn.
  float stretch = kAlways;

  static constexpr float kAlways = -1.0f;
  // A sliver's stretch runs from the one to the other: it counts as narrow up to kSliver times the
  // width up to which a skin does. kSliverSide is not 0, so that slivers have vertices of their
  // own.
  static constexpr float kSliverSide = 0x1p-20f, kSliver = 4.0f;
};

// The triangles [first, first + count) of a mesh.
struct TriangleRange {
  std::uint32_t first = 0, count = 0;
};

// The mesh of a node.
struct NodeMesh {
  glm::dmat4 world_from_node{1.0};  // rigid
  int face_size = 0;                // texels
  std::vector<NodeVertex> vertices;
  // Three for each triangle: first the surfaces face by face, then the skins face by face.
  std::vector<std::uint32_t> indices;
  std::array<TriangleRange, 6> surfaces, skins;
  // For each triangle, as seen from the node's own eye: |cos| of the angle between its normal and
  // the line of sight to its middle (S3.4); 0 for skins.
  std::vector<float> quality;
  // Of each face, as texel_weights().
  std::array<Image<std::uint8_t>, 6> weights;

  [[nodiscard]] std::size_t triangles() const { return indices.size() / 3; }
  [[nodiscard]] std::size_t surface_triangles() const {
    return std::size_t(surfaces[5].first) + surfaces[5].count;
  }
};

// The size and the error of a mesh.
struct TriangulateOptions {
  // The largest number of triangles of surfaces; 0: limited by the error alone.
  std::size_t triangles = 0;
  // Refinement ends when no texel has a larger error, in pixels seen by an eye `reach` metres from
  // the node in a frame as fine as the faces. (Parallax is reach times disparity.)
  double error_px = 0.5;
  // Metres; 0: a quarter of the median distance of the surfaces.
  double reach = 0;
  // The share of the budget for silhouettes. Beyond it, the least important ones are left out and
  // surfaces stretch there.
  double silhouette_share = 0.8;
};

// The results of a triangulation.
struct TriangulateStats {
  double reach = 0;       // metres, as used
  float worst_error = 0;  // 1/m, of any texel
  double worst_error_px = 0;
  std::size_t silhouette_triangles = 0;  // needed by silhouettes alone
  std::size_t silhouettes = 0, left_out = 0;
};

// Triangulates a node. Requires a valid environment (validate_environment). Faces run in parallel;
// the mesh does not depend on the number of threads.
[[nodiscard]] NodeMesh triangulate(const EnvironmentMap& map, const TriangulateOptions& options,
                                   TriangulateStats* stats = nullptr);

// |cos| of the angle between a triangle's normal and the line of sight to its middle (S3.4).
[[nodiscard]] float triangle_quality(const NodeVertex& a, const NodeVertex& b, const NodeVertex& c);

// The memory of a mesh, bytes.
[[nodiscard]] std::size_t bytes(const NodeMesh& mesh);

}  // namespace rilievo

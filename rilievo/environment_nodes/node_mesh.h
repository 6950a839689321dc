// What is drawn of an environment node: one textured triangle mesh around the point from which its
// six faces were taken (S3.2).
//
// A vertex lies at `direction` / `disparity` from the node, in the node's own space: direction is a
// point of the cube [-1, 1]^3 and disparity 1 / eye_z of a face that it lies on, so that the sky,
// infinitely far, is drawn by the same triangles (disparity 0). Faces share the vertices on the
// cube's edges, and both sides of a silhouette lie on the same lines of sight: from the node's own
// eye the mesh has no crack, and with its skins it is closed.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

struct NodeVertex {
  glm::vec3 direction{0, 0, 1};
  float disparity = 0;
  // Where a skin takes its colour from: a little inside the surface at whose border it begins. The
  // direction itself for vertices of surfaces.
  glm::vec3 texture{0, 0, 1};
  // Of a skin: 0 at its nearer border, 1 at the farther; how fast it changes over the frame says
  // how wide the skin is there. kAlways where it is always to be drawn.
  float stretch = kAlways;

  static constexpr float kAlways = -1.0f;
};

// [first, first + count) of a mesh's triangles.
struct TriangleRange {
  std::uint32_t first = 0, count = 0;
};

struct NodeMesh {
  glm::dmat4 world_from_node{1.0};  // rigid
  int face_size = 0;                // texels
  std::vector<NodeVertex> vertices;
  // Three a triangle: first the surfaces face by face, then skins face by face.
  std::vector<std::uint32_t> indices;
  std::array<TriangleRange, 6> surfaces, skins;
  // By triangle, of what it shows to the node's own eye: |cos| of the angle between its normal and
  // the line of sight to its middle (S3.4); 0 for skins.
  std::vector<float> quality;

  [[nodiscard]] std::size_t triangles() const { return indices.size() / 3; }
  [[nodiscard]] std::size_t surface_triangles() const {
    return std::size_t(surfaces[5].first) + surfaces[5].count;
  }
};

struct TriangulateOptions {
  // What limits the mesh: so many triangles of surfaces, or, if 0, the error alone.
  std::size_t triangles = 0;
  // Stop when no texel is wrong by more: pixels, seen by an eye `reach` metres from the node in a
  // frame as fine as the faces. (Parallax is reach times disparity.)
  double error_px = 0.5;
  // Metres; 0: a quarter of the median distance of what the faces show.
  double reach = 0;
  // Share of the budget that silhouettes may take; those that tell least are left out first, and
  // surfaces stretch there.
  double silhouette_share = 0.6;
};

struct TriangulateFigures {
  double reach = 0;       // metres, as used
  float worst_error = 0;  // 1/m, of any texel
  double worst_error_px = 0;
  std::size_t silhouette_triangles = 0;  // that silhouettes alone need
  std::size_t silhouettes = 0, left_out = 0;
};

// Requires a valid environment (validate_environment). Faces run in parallel; the mesh does not
// depend on the number of threads.
[[nodiscard]] NodeMesh triangulate(const EnvironmentMap& map, const TriangulateOptions& options,
                                   TriangulateFigures* figures = nullptr);

// |cos| of the angle between a triangle's normal and the line of sight to its middle (S3.4).
[[nodiscard]] float triangle_quality(const NodeVertex& a, const NodeVertex& b, const NodeVertex& c);

[[nodiscard]] std::size_t bytes(const NodeMesh& mesh);

}  // namespace rilievo

// What is kept of surroundings? Nodes, each with six pictures with depth around a point (S3.1).
//
// The pictures are in memory, or in a file from which they are read when needed. A sketch of each
// node is in memory, from which nodes are chosen for an eye (S3.8). Meshes are computed from the
// pictures when a node is loaded, with the same result each time. World space, metres.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/stroke_size.h"
#include "rilievo/environment_nodes/fit_sky.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// A node in low resolution.
struct NodeSketch {
  static constexpr int kSize = 24;

  glm::dmat4 world_from_node{1.0};
  int face_size = 0;   // texels
  double covered = 0;  // share of the texels that show a surface (not the sky)
  Box bounds;          // of these surfaces
  // The distance along the line of sight of what a direction shows, kSize x kSize for each face;
  // infinite for the sky, 0 where nothing is shown.
  std::array<Image<float>, 6> distance;
  SkySums sky;
  // 1 / eye_z of its face of what a direction shows, as the upper halves of floats; 0 for the sky,
  // infinite where nothing is shown. Finer than `distance`: surfaces that are seen from beside are
  // a few texels wide. From it the nodes of a frame are chosen (nodes_for_frame.h).
  std::array<Image<std::uint16_t>, 6> disparity;
  // How far nothing is seen within kClearAngle of any direction of a part of a face, of kClearSize
  // x kClearSize of them, from above.
  static constexpr int kClearSize = 16;
  static constexpr double kClearAngle = 0.15;
  std::array<Image<float>, 6> clear;

  [[nodiscard]] glm::dvec3 eye() const { return glm::dvec3(world_from_node[3]); }
};

// All nodes of a place.
struct EnvironmentNodes {
  std::string name;
  TriangulateOptions mesh;
  std::vector<NodeSketch> nodes;  // at least one
  // Six for each node, in order; or empty if they are in `file`.
  std::vector<DepthImage> pictures;
  std::filesystem::path file;
  StrokeSize strokes;  // the largest of the points and lines that the pictures show

  [[nodiscard]] Box bounds() const;
  [[nodiscard]] std::size_t bytes() const;
  // The sky that they saw; none if they saw none.
  [[nodiscard]] std::optional<Sky> sky() const;
};

// The sketch of one of `nodes` nodes. Their disparities take at most 16 MB together, and have at
// most 256 x 256 texels a face. Requires a valid environment.
[[nodiscard]] NodeSketch make_sketch(const EnvironmentMap& map, std::size_t nodes);

// Makes nodes of six pictures each. The error names the node and the face that are invalid.
[[nodiscard]] Result<EnvironmentNodes> make_environment_nodes(std::vector<DepthImage> pictures,
                                                              const TriangulateOptions& mesh);

// A node's pictures, from memory or from the file. Any thread.
[[nodiscard]] Result<EnvironmentMap> load_node(const EnvironmentNodes& nodes, std::size_t node);

// The nodes to draw for an eye, the best first: nearest first, those that see the eye before the
// others (S3.8).
[[nodiscard]] std::vector<std::size_t> nodes_for_eye(const EnvironmentNodes& nodes,
                                                     const glm::dvec3& eye);
// Is there no surface between node and eye? Approximate, from the sketch.
[[nodiscard]] bool sees(const NodeSketch& node, const glm::dvec3& eye);

}  // namespace rilievo

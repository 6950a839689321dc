// What is kept of surroundings: nodes, each six pictures with depth around a point (S3.1).
//
// The pictures are in memory, or in a file from which they are read as they are needed; of every
// node a sketch is in memory, from which nodes are chosen for an eye (S3.8). Meshes are made again
// from the pictures whenever a node is loaded: the same ones each time. World space, metres.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

struct NodeSketch {
  static constexpr int kSize = 24;

  glm::dmat4 world_from_node{1.0};
  int face_size = 0;   // texels
  double covered = 0;  // share of the texels that show a surface, not the sky
  Box bounds;          // of these surfaces
  // How far along its line of sight lies what a direction shows: kSize x kSize of a face;
  // infinite for the sky, 0 where nothing is shown.
  std::array<Image<float>, 6> distance;

  [[nodiscard]] glm::dvec3 eye() const { return glm::dvec3(world_from_node[3]); }
};

struct EnvironmentNodes {
  std::string name;
  TriangulateOptions mesh;
  std::vector<NodeSketch> nodes;  // at least one
  // Six a node, in order; or empty: they are in `file`.
  std::vector<DepthImage> pictures;
  std::filesystem::path file;

  [[nodiscard]] Box bounds() const;
  [[nodiscard]] std::size_t bytes() const;
};

// Requires a valid environment.
[[nodiscard]] NodeSketch make_sketch(const EnvironmentMap& map);

// Six pictures a node. The error says which node's which face is no good.
[[nodiscard]] Result<EnvironmentNodes> make_environment_nodes(std::vector<DepthImage> pictures,
                                                              const TriangulateOptions& mesh);

// The node's pictures, from memory or from the file. Any thread.
[[nodiscard]] Result<EnvironmentMap> load_node(const EnvironmentNodes& nodes, std::size_t node);

// Which nodes should be drawn for an eye, the best first? Those that see the eye, the nearest
// first; then all others, the nearest first. (S3.8)
[[nodiscard]] std::vector<std::size_t> nodes_for_eye(const EnvironmentNodes& nodes,
                                                     const glm::dvec3& eye);
// Does nothing that the node shows lie between the two? By its sketch: about.
[[nodiscard]] bool sees(const NodeSketch& node, const glm::dvec3& eye);

}  // namespace rilievo

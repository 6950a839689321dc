// How wrong may a node's mesh look from a new eye, at most?
//
// Compared with the node's own samples: each texel's centre, at its captured depth, is drawn
// somewhere else, because the triangles do not pass through it; and between two surfaces that part
// at a silhouette a gap opens (or a skin stretches). Both are parallax: differences of disparity
// along one line of sight, seen from the side. What lies between samples, within a texel of a
// silhouette, is nobody's knowledge and not bounded.
//
// Kept for blocks of 16 x 16 texels; a bound is evaluated for an eye in about ten microseconds for
// faces of 256 texels. The node's own space, metres.
#pragma once

#include <array>
#include <vector>

#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// Disparity of what the mesh's surfaces show at each texel's centre of a face, the nearest one;
// kNothing where there is none. Of any mesh whose `surfaces` are triangles over faces.
[[nodiscard]] Image<float> seen_disparity(const NodeMesh& mesh, int face);

struct NodeErrorModel {
  static constexpr int kBlock = 16;
  struct Block {
    glm::vec3 toward{0, 0, 1};  // unit; to its middle
    float half_angle = 0;       // its texels lie within, radians
    // 1 / distance along the line of sight, of samples and mesh together, and how far the two
    // differ at most.
    float least = 0, most = 0, error = 0;
    // Of skins that begin here: the reach of disparities they span, and the widest span.
    float skin_least = 0, skin_most = 0, gap = 0;
  };
  glm::dmat4 world_from_node{1.0};
  std::vector<Block> blocks;  // those that show something
};

[[nodiscard]] NodeErrorModel make_error_model(const EnvironmentMap& map, const NodeMesh& mesh);

// Angles at the eye, radians; pi where nothing can be said (an eye at or behind a surface).
struct NodeBound {
  double error = 0;  // between a sample and where it is drawn
  double gap = 0;    // width of a gap
};
// `eye` in the world.
[[nodiscard]] NodeBound bound(const NodeErrorModel& model, const glm::dvec3& eye);

// The same in pixels of a perspective frame, anywhere in it: an angle is widest in the corners.
[[nodiscard]] NodeBound bound_px(const NodeErrorModel& model, const Camera& frame);

}  // namespace rilievo

// How large is the error of a node's mesh seen from a new eye, at most?
//
// Compared with the node's own samples. Each texel's centre, at its captured depth, is drawn
// elsewhere because the triangles do not pass through it; and at a silhouette a gap opens between
// two surfaces (or a skin stretches). Both are parallax: differences of disparity along one line of
// sight, seen from the side. What lies between samples, within a texel of a silhouette, is unknown
// and not bounded. Points and lines face the node instead of the eye, and lines are some texels
// wide: that counts beside.
//
// Stored for blocks of 16 x 16 texels. Evaluating the bound for an eye takes about ten microseconds
// for faces of 256 texels. Node space, metres.
#pragma once

#include <array>
#include <vector>

#include "rilievo/core/stroke_size.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// The disparity of the nearest mesh surface at each texel centre of a face; kNothing where there is
// none. For any mesh whose `surfaces` are triangles over faces.
[[nodiscard]] Image<float> seen_disparity(const NodeMesh& mesh, int face);

// The error of a node, block by block.
struct NodeErrorModel {
  static constexpr int kBlock = 16;
  // The texels of a block.
  struct Block {
    glm::vec3 toward{0, 0, 1};  // unit direction to its middle
    float half_angle = 0;       // all texels lie within this angle of it, radians
    // 1 / distance along the line of sight, of samples and mesh together, and the largest
    // difference of the two.
    float least = 0, most = 0, error = 0;
    // Of the skins that cross the block: the least and the largest 1 / distance of both their
    // sides, and the largest difference between the two sides. gap 0: there is no skin.
    float skin_least = 0, skin_most = 0, gap = 0;
  };
  glm::dmat4 world_from_node{1.0};
  // Without those that have no error: with strokes, all that show something.
  std::vector<Block> blocks;
  // The largest of the points and lines that the environment may show anywhere, and the angle
  // between a texel's centre and its corner, at most.
  StrokeSize strokes;
  double half_texel = 0;
};

// Computes the model. Requires a mesh of this environment.
[[nodiscard]] NodeErrorModel make_error_model(const EnvironmentMap& map, const NodeMesh& mesh,
                                              const StrokeSize& strokes = {});

// Upper bounds, as angles at the eye in radians; pi where there is no bound (an eye at or behind a
// surface).
struct NodeBound {
  double error = 0;       // between a sample's true and drawn positions
  double gap = 0;         // width of a gap
  double disc = 0;        // beside `error`, of points: their discs face the node, not the eye
  double half_texel = 0;  // from a texel's centre to its corner, where lines look widest
};
// The bounds for an eye in world space.
[[nodiscard]] NodeBound bound(const NodeErrorModel& model, const glm::dvec3& eye);

// The bounds in pixels of a perspective frame, anywhere in it: an angle covers most pixels in the
// corners.
[[nodiscard]] NodeBound bound_px(const NodeErrorModel& model, const Camera& frame);

}  // namespace rilievo

#include "rilievo/environment_nodes/visible_faces.h"

#include <algorithm>

#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {

std::array<SideReach, 6> side_reaches(const NodeMesh& mesh) {
  std::array<SideReach, 6> reaches;
  for (std::size_t f = 0; f < 6; ++f)
    for (const TriangleRange& range : {mesh.surfaces[f], mesh.skins[f]})
      for (std::size_t i = 3 * std::size_t(range.first);
           i < 3 * (std::size_t(range.first) + range.count); ++i) {
        const float d = mesh.vertices[mesh.indices[i]].disparity;
        SideReach& reach = reaches[f];
        reach.least_disparity = reach.empty ? d : std::min(reach.least_disparity, d);
        reach.most_disparity = reach.empty ? d : std::max(reach.most_disparity, d);
        reach.empty = false;
      }
  return reaches;
}

// A point at c / d from the node's place E is R c / d + E in the world, so that relative to the eye
// and times d it is R c + (E - eye) d.
glm::dmat4 clip_from_node(const NodeMesh& mesh, const Camera& frame) {
  glm::dmat4 relative = mesh.world_from_node;
  relative[3] = glm::dvec4(glm::dvec3(mesh.world_from_node[3]) - frame.position(), 1);
  return clip_from_relative(frame) * relative;
}

std::array<bool, 6> visible_faces(const NodeMesh& mesh, const std::array<SideReach, 6>& reaches,
                                  const Camera& frame) {
  const glm::dmat4 to_clip = clip_from_node(mesh, frame);
  const glm::dmat3 node_from_world = glm::transpose(glm::dmat3(mesh.world_from_node));
  const glm::dvec3 eye = node_from_world * (frame.position() - glm::dvec3(mesh.world_from_node[3]));
  glm::dvec3 rays[4];
  for (int k = 0; k < 4; ++k)
    rays[k] = node_from_world *
              (world_from_raster(frame, {(k & 1) * frame.width, (k >> 1) * frame.height}, 1.0) -
               frame.position());
  std::array<bool, 6> visible{};
  for (std::size_t f = 0; f < 6; ++f) {
    if (reaches[f].empty) continue;
    const FaceAxes& axes = face_axes()[f];
    const glm::dvec3 forward(axes.forward), right(axes.right), up(axes.up);
    // All that the side shows lies between these eight, homogeneous, whatever sign w has.
    int outside = 0x1F;
    for (int k = 0; k < 8; ++k) {
      const glm::dvec3 c = forward + ((k & 1) ? right : -right) + ((k & 2) ? up : -up);
      const double d = (k & 4) ? reaches[f].most_disparity : reaches[f].least_disparity;
      const glm::dvec4 p = to_clip * glm::dvec4(c, d);
      outside &= int(p.x < -p.w) | int(p.x > p.w) << 1 | int(p.y < -p.w) << 2 |
                 int(p.y > p.w) << 3 | int(p.w < 0) << 4;
    }
    // And the frustum lies between these rays: is it beyond one of the pyramid's planes?
    bool apart = false;
    for (const glm::dvec3& inwards :
         {forward + right, forward - right, forward + up, forward - up}) {
      bool beyond = glm::dot(inwards, eye) < 0;
      for (const glm::dvec3& ray : rays) beyond = beyond && glm::dot(inwards, ray) < 0;
      apart = apart || beyond;
    }
    visible[f] = !outside && !apart;
  }
  return visible;
}

}  // namespace rilievo

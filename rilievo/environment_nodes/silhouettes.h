// Along which lines do a face's surfaces end?
//
// Cut gates (cube_grid.h) form chains between texels; each becomes a polyline with few vertices
// that still has every texel's centre on its own side, an eighth of a texel's half width away at
// least. So the lines of different chains do not meet except at common ends. Half texels.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {

struct Silhouette {
  // Corners of texels, in texels: a unit step each; where surfaces meet or a chain begins and ends,
  // on the face's border too; a closed one ends where it begins.
  std::vector<glm::ivec2> corners;
  // The polyline, half texels: the first and the last corner, between them middles of gates.
  std::vector<glm::ivec2> line;
  double worth = 0;         // sum over its gates of squared steps of disparity
  bool to_nothing = false;  // ends at what shows nothing: cannot be joined
};

// In the order in which the face's rows meet them.
[[nodiscard]] std::vector<Silhouette> trace_silhouettes(const CubeGrid& grid, int face);

// The polyline of a chain of corners, as above.
[[nodiscard]] std::vector<glm::ivec2> straightened(std::span<const glm::ivec2> corners);

}  // namespace rilievo

// Along which lines do a face's surfaces end?
//
// Cut gates (cube_grid.h) form chains between texels. Each chain becomes a polyline with few
// vertices that has every texel centre on its own side, at a distance of at least an eighth of half
// a texel. Therefore lines of different chains meet only at common ends. Half texels.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {

// A chain and its polyline.
struct Silhouette {
  // Texel corners, in texels, one unit step apart. The chain begins and ends where surfaces meet,
  // also on the face's border; a closed chain ends where it begins.
  std::vector<glm::ivec2> corners;
  // The polyline, in half texels: the first and the last corner, and between them middles of gates.
  std::vector<glm::ivec2> line;
  double worth = 0;         // sum of squared disparity steps over its gates
  bool to_nothing = false;  // borders kNothing; cannot be joined
};

// The silhouettes of a face, in the order of its rows.
[[nodiscard]] std::vector<Silhouette> trace_silhouettes(const CubeGrid& grid, int face);

// The polyline of a chain of corners, as above.
[[nodiscard]] std::vector<glm::ivec2> straightened(std::span<const glm::ivec2> corners);

}  // namespace rilievo

// How is the result of a pre-warp divided into tiles?
//
// Internal to the folder.
#pragma once

#include <glm/glm.hpp>

namespace rilievo {

// Rectangles of the result: [min, max).
struct Texels {
  glm::ivec2 min{0}, max{0};
  [[nodiscard]] bool empty() const { return min.x >= max.x || min.y >= max.y; }
  [[nodiscard]] glm::ivec2 size() const { return max - min; }
};
inline Texels overlap(const Texels& a, const Texels& b) {
  return {glm::max(a.min, b.min), glm::min(a.max, b.max)};
}

// How the result is divided: tile (x, y) begins at origin + (x, y) * size.
struct TileGrid {
  glm::ivec2 origin{0}, size{256};
  [[nodiscard]] Texels texels_of(const glm::ivec2& tile) const {
    return {origin + tile * size, origin + (tile + 1) * size};
  }
  // The tiles that overlap `texels`.
  [[nodiscard]] Texels tiles_of(const Texels& texels) const;
};

// a / b, rounded down.
inline int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

inline Texels TileGrid::tiles_of(const Texels& texels) const {
  const glm::ivec2 first = texels.min - origin, last = texels.max - 1 - origin;
  return {{floor_div(first.x, size.x), floor_div(first.y, size.y)},
          {floor_div(last.x, size.x) + 1, floor_div(last.y, size.y) + 1}};
}

}  // namespace rilievo

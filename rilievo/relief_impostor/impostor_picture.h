// What does the pre-warp of relief impostors read? A nailboard of few depth levels. (S5.2)
//
// A perspective picture, from any software shader: at its own eye it is shown as it was shaded.
// Texels are colour and level; rows from the top, with texels that show nothing beyond their ends.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

// The pre-warp has a table with an entry for each level (the paper: 255). 12 bits move a texel by
// at most 1/8000 of the largest parallax.
constexpr int kLevelBits = 12;
// The level of a texel that shows nothing.
constexpr std::uint32_t kEmptyLevel = delta_transparent(kLevelBits);

// A texel of a picture that is read or made by the pre-warp.
struct WarpTexel {
  std::uint32_t color = 0;           // R, G, B, A from the lowest byte, as a Nailboard's
  std::uint32_t code = kEmptyLevel;  // the level; between the passes: see warp_passes.h
};

// The picture.
struct ImpostorPicture {
  PictureGeometry geometry;       // with kLevelBits of Delta
  int pitch = 0;                  // texels from row to row
  std::vector<WarpTexel> texels;  // height rows
  // The texels that show something, [min, max), and their levels; empty if max.x is 0.
  glm::ivec2 min{0}, max{0};
  std::uint32_t nearest = 0, farthest = 0;

  [[nodiscard]] int width() const { return geometry.capture.width; }
  [[nodiscard]] int height() const { return geometry.capture.height; }
  [[nodiscard]] bool empty() const { return max.x == 0; }
  [[nodiscard]] const WarpTexel& at(int x, int y) const {
    return texels[std::size_t(y) * std::size_t(pitch) + std::size_t(x)];
  }
};

// Requires kLevelBits of Delta. Texels without colour are empty.
[[nodiscard]] ImpostorPicture impostor_picture(const Nailboard& nailboard);
// Of a perspective picture, which may be larger than what it shows.
[[nodiscard]] ImpostorPicture impostor_picture(const DepthImage& picture);

}  // namespace rilievo

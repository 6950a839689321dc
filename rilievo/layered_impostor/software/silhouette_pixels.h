// Which pixels of a tile lie along silhouettes? Internal to `layered_impostor/software`.
//
// A silhouette passes between the centres of two neighbouring pixels if one shows the impostor and
// the other one does not.
#pragma once

#include <array>
#include <cstdint>

#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// A bit for each pixel of a tile, the leftmost or topmost one lowest, and for each pixel beside it.
struct TileBits {
  static_assert(FrameTile::kSize == 64);
  std::array<std::uint64_t, 64> row{};
  std::uint64_t above = 0, below = 0, left = 0, right = 0;

  // From -1 to 64, not in the corners.
  void set(int x, int y) {
    if (y < 0 || y > 63)
      (y < 0 ? above : below) |= std::uint64_t(1) << x;
    else if (x < 0 || x > 63)
      (x < 0 ? left : right) |= std::uint64_t(1) << y;
    else
      row[std::size_t(y)] |= std::uint64_t(1) << x;
  }
  [[nodiscard]] bool has(int x, int y) const {
    if (y < 0 || y > 63) return x >= 0 && x <= 63 && ((y < 0 ? above : below) >> x & 1);
    if (x < 0 || x > 63) return (x < 0 ? left : right) >> y & 1;
    return row[std::size_t(y)] >> x & 1;
  }
  // A pixel of the tile, or one of its four neighbours.
  [[nodiscard]] std::uint64_t around(int y) const {
    const std::uint64_t own = row[std::size_t(y)];
    return own | own << 1 | own >> 1 | (left >> y & 1) | (right >> y & 1) << 63 |
           (y > 0 ? row[std::size_t(y - 1)] : above) | (y < 63 ? row[std::size_t(y + 1)] : below);
  }
};

// The pixels that were `asked` for, and lie along a silhouette of what is `shown`: they or
// neighbours of theirs show it, and they or neighbours of theirs do not. Neighbours that were not
// asked for do not count.
[[nodiscard]] inline TileBits silhouette_pixels(const TileBits& asked, const TileBits& shown) {
  TileBits missing, along;
  for (std::size_t y = 0; y < 64; ++y) missing.row[y] = asked.row[y] & ~shown.row[y];
  missing.above = asked.above & ~shown.above, missing.below = asked.below & ~shown.below;
  missing.left = asked.left & ~shown.left, missing.right = asked.right & ~shown.right;
  for (int y = 0; y < 64; ++y)
    along.row[std::size_t(y)] = asked.row[std::size_t(y)] & shown.around(y) & missing.around(y);
  return along;
}

}  // namespace rilievo

// Which pixels of a tile lie along silhouettes? Internal to `layered_impostor/software`.
//
// A silhouette passes between the centres of two neighbouring pixels if one shows the impostor and
// the other one does not.
#pragma once

#include <array>
#include <cstdint>

#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// A bit for each pixel of a tile, the leftmost one lowest.
struct TileBits {
  static_assert(FrameTile::kSize == 64);
  std::array<std::uint64_t, 64> row{};

  void set(int x, int y) { row[std::size_t(y)] |= std::uint64_t(1) << x; }
  [[nodiscard]] bool has(int x, int y) const { return row[std::size_t(y)] >> x & 1; }
  // A pixel, or one of its four neighbours in the tile.
  [[nodiscard]] std::uint64_t around(int y) const {
    const std::uint64_t own = row[std::size_t(y)];
    return own | own << 1 | own >> 1 | (y > 0 ? row[std::size_t(y - 1)] : 0) |
           (y < 63 ? row[std::size_t(y + 1)] : 0);
  }
};

// The pixels that were `asked` for, and lie along a silhouette of what is `shown`: they or
// neighbours of theirs show it, and they or neighbours of theirs do not. Neighbours in other tiles,
// and those that were not asked for, do not count.
[[nodiscard]] inline TileBits silhouette_pixels(const TileBits& asked, const TileBits& shown) {
  TileBits missing, along;
  for (std::size_t y = 0; y < 64; ++y) missing.row[y] = asked.row[y] & ~shown.row[y];
  for (int y = 0; y < 64; ++y)
    along.row[std::size_t(y)] = asked.row[std::size_t(y)] & shown.around(y) & missing.around(y);
  return along;
}

}  // namespace rilievo

// Where a block of a tile lies in its frame.
#pragma once

#include <algorithm>

#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Its upper left pixel, which may lie beyond the frame, and those of its pixels that lie within.
struct BlockPlace {
  int x, y, columns, rows;

  BlockPlace(const FrameTile& tile, int block)
      : x(tile.x + block % FrameTile::kBlocks * FrameTile::kBlock),
        y(tile.y + block / FrameTile::kBlocks * FrameTile::kBlock),
        columns(std::min(FrameTile::kBlock, tile.width - x)),
        rows(std::min(FrameTile::kBlock, tile.height - y)) {}
  // Is any of its pixels within the frame?
  [[nodiscard]] bool within() const { return columns > 0 && rows > 0; }
};

}  // namespace rilievo

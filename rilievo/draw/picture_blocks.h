// Which parts of a picture show anything, and which hide whatever lies behind them?
//
// Of every block of 4 x 4 texels of an atlas: its nearest and its farthest Delta, and whether all
// of its texels are opaque. Lets a drawer leave out what is empty or hidden (visible_cells.h), and
// tells how deep a picture really is. Rows as OpenGL has them, the lowest first. No OpenGL here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/draw/atlas_allocator.h"
#include "rilievo/represent/picture_geometry.h"

namespace rilievo {

// Two bytes, as a texel of a texture. Deltas are rounded away from the middle of the block.
struct PictureBlock {
  std::uint8_t nearest = 255;  // of its texels, in steps of 1 / 254; 255: none shows anything
  std::uint8_t farthest = 0;   // of its texels, in steps of 1 / 127, times 2; + 1: all are opaque

  [[nodiscard]] bool empty() const { return nearest == 255; }
  [[nodiscard]] bool opaque() const { return (farthest & 1) != 0; }
  [[nodiscard]] double nearest_delta() const { return nearest / 254.0; }
  [[nodiscard]] double farthest_delta() const { return (farthest >> 1) / 127.0; }
  friend bool operator==(const PictureBlock&, const PictureBlock&) = default;
};
inline constexpr int kBlockTexels = 4;  // a side

// Looked at before their blocks.
inline constexpr int kCellBlocks = 4, kCellTexels = kCellBlocks * kBlockTexels;

// Of one picture.
struct PictureBlocksView {
  const PictureBlock* blocks = nullptr;     // lower left
  const std::uint8_t* cells = nullptr;      // nearest of their blocks'
  std::size_t block_row = 0, cell_row = 0;  // entries from one row to the next
  int width = 0, height = 0;                // texels

  [[nodiscard]] const PictureBlock& block(int x, int y) const {
    return blocks[std::size_t(y) * block_row + std::size_t(x)];
  }
  [[nodiscard]] std::uint8_t cell(int x, int y) const {
    return cells[std::size_t(y) * cell_row + std::size_t(x)];
  }
};

[[nodiscard]] inline int blocks_across(int texels) {
  return (texels + kBlockTexels - 1) / kBlockTexels;
}
[[nodiscard]] inline int cells_across(int texels) {
  return (texels + kCellTexels - 1) / kCellTexels;
}

// The nearest and the farthest Delta of a picture; nothing if it is empty.
[[nodiscard]] std::optional<DeltaRange> delta_range(const PictureBlocksView& blocks);

// Of all pictures of an atlas.
class PictureBlocks {
 public:
  explicit PictureBlocks(int layers);

  // `blocks`: rows of blocks_across(slot.width), lowest first.
  void assign(const AtlasSlot& slot, std::span<const PictureBlock> blocks);
  [[nodiscard]] PictureBlocksView view(const AtlasSlot& slot) const;

  static constexpr int kLayerBlocks = AtlasAllocator::kLayerSize / kBlockTexels;  // a side
  static constexpr int kLayerCells = AtlasAllocator::kLayerSize / kCellTexels;

 private:
  // Of a slot's lower left corner.
  [[nodiscard]] static std::size_t first_block(const AtlasSlot& slot);
  [[nodiscard]] static std::size_t first_cell(const AtlasSlot& slot);

  std::vector<PictureBlock> blocks_;  // by layer, row, column
  std::vector<std::uint8_t> cells_;
};

}  // namespace rilievo

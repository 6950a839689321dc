// The parts of a picture that show anything, and those that hide what lies behind them.
//
// For each block of 4 x 4 texels of an atlas: the nearest and the farthest Delta, and which texels
// are covered or opaque. Drawers skip blocks that are empty or hidden (visible_cells.h), and the
// range of Deltas tells how deep a picture is. Rows as in OpenGL, the bottom one first. No OpenGL.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/picture_geometry.h"
#include "rilievo/nailboard/atlas_allocator.h"

namespace rilievo {

inline constexpr int kBlockTexels = 4;  // texels a side

// A block. Deltas are in steps of 1 / 254, rounded outwards.
struct OcclusionTile {
  std::uint8_t nearest = 255;  // 255: no texel is covered
  std::uint8_t farthest = 0;
  std::uint16_t covered = 0;  // bit x + 4 y: texel (x, y) has a Delta
  std::uint16_t opaque = 0;   // likewise: the texel hides what is behind it

  [[nodiscard]] bool empty() const { return covered == 0; }
  [[nodiscard]] double nearest_delta() const { return nearest / 254.0; }
  [[nodiscard]] double farthest_delta() const { return farthest / 254.0; }
  friend bool operator==(const OcclusionTile&, const OcclusionTile&) = default;
};
static_assert(sizeof(OcclusionTile) == 6, "three words, as they are read from a texture");

// Cells of blocks, which are tested before their blocks. Blocks and texels a side.
inline constexpr int kCellBlocks = 4, kCellTexels = kCellBlocks * kBlockTexels;

// The blocks and cells of one picture.
struct OcclusionTilesView {
  const OcclusionTile* blocks = nullptr;    // bottom left block
  const std::uint8_t* cells = nullptr;      // the nearest Delta of each cell's blocks
  std::size_t block_row = 0, cell_row = 0;  // entries from one row to the next
  int width = 0, height = 0;                // texels

  [[nodiscard]] const OcclusionTile& block(int x, int y) const {
    return blocks[std::size_t(y) * block_row + std::size_t(x)];
  }
  [[nodiscard]] std::uint8_t cell(int x, int y) const {
    return cells[std::size_t(y) * cell_row + std::size_t(x)];
  }
};

// The bits of those texels of a block that lie between `from` and `to` inclusive (texels of the
// picture, from its bottom left corner). At least one must lie in the block.
[[nodiscard]] inline std::uint16_t texels_of_block(const glm::ivec2& block, const glm::ivec2& from,
                                                   const glm::ivec2& to) {
  constexpr int kLast = kBlockTexels - 1;
  const glm::ivec2 low = glm::max(from - kBlockTexels * block, glm::ivec2(0));
  const glm::ivec2 high = glm::min(to - kBlockTexels * block, glm::ivec2(kLast));
  const unsigned columns = (0xFu << low.x) & (0xFu >> (kLast - high.x));
  const unsigned rows = (0x1111u << (4 * low.y)) & (0x1111u >> (4 * (kLast - high.y)));
  return std::uint16_t(columns * rows);
}

// The number of blocks, and of cells, across a picture.
[[nodiscard]] inline int blocks_across(int texels) {
  return (texels + kBlockTexels - 1) / kBlockTexels;
}
[[nodiscard]] inline int cells_across(int texels) {
  return (texels + kCellTexels - 1) / kCellTexels;
}

// The nearest and the farthest Delta of a picture; none if it is empty.
[[nodiscard]] std::optional<DeltaRange> delta_range(const OcclusionTilesView& blocks);

// The blocks of all pictures of an atlas.
class OcclusionTiles {
 public:
  explicit OcclusionTiles(int layers);

  // Sets the blocks of a picture: rows of blocks_across(slot.width), bottom row first.
  void assign(const AtlasSlot& slot, std::span<const OcclusionTile> blocks);
  // The blocks of the picture in `slot`.
  [[nodiscard]] OcclusionTilesView view(const AtlasSlot& slot) const;

  static constexpr int kLayerBlocks = AtlasAllocator::kLayerSize / kBlockTexels;  // a side
  static constexpr int kLayerCells = AtlasAllocator::kLayerSize / kCellTexels;

 private:
  // The block, and the cell, of a slot's lower left corner.
  [[nodiscard]] static std::size_t first_block(const AtlasSlot& slot);
  [[nodiscard]] static std::size_t first_cell(const AtlasSlot& slot);

  std::vector<OcclusionTile> blocks_;  // by layer, row, column
  std::vector<std::uint8_t> cells_;
};

}  // namespace rilievo

#include "rilievo/draw/picture_blocks.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {

static_assert(AtlasAllocator::kCell % kCellTexels == 0, "no cell reaches into two pictures");

std::optional<DeltaRange> delta_range(const PictureBlocksView& blocks) {
  DeltaRange range{2, -1};
  for (int y = 0; y < blocks_across(blocks.height); ++y)
    for (int x = 0; x < blocks_across(blocks.width); ++x) {
      const PictureBlock& block = blocks.block(x, y);
      if (block.empty()) continue;
      range.nearest = std::min(range.nearest, block.nearest_delta());
      range.farthest = std::max(range.farthest, block.farthest_delta());
    }
  if (range.nearest > range.farthest) return {};
  return range;
}

PictureBlocks::PictureBlocks(int layers)
    : blocks_(std::size_t(layers) * kLayerBlocks * kLayerBlocks),
      cells_(std::size_t(layers) * kLayerCells * kLayerCells, 255) {}

void PictureBlocks::assign(const AtlasSlot& slot, std::span<const PictureBlock> blocks) {
  const int columns = blocks_across(slot.width), rows = blocks_across(slot.height);
  RILIEVO_EXPECTS_EQ(blocks.size(), std::size_t(columns) * std::size_t(rows));
  const std::size_t row0 =
      std::size_t(slot.layer) * kLayerBlocks + std::size_t(slot.y) / kBlockTexels;
  const std::size_t column0 = std::size_t(slot.x) / kBlockTexels;
  for (int y = 0; y < rows; ++y)
    std::copy_n(blocks.begin() + std::ptrdiff_t(y) * columns, columns,
                blocks_.begin() + std::ptrdiff_t((row0 + std::size_t(y)) * kLayerBlocks + column0));
  const std::size_t cell_row0 =
      std::size_t(slot.layer) * kLayerCells + std::size_t(slot.y) / kCellTexels;
  const std::size_t cell_column0 = std::size_t(slot.x) / kCellTexels;
  for (int y = 0; y < cells_across(slot.height); ++y)
    for (int x = 0; x < cells_across(slot.width); ++x) {
      std::uint8_t nearest = 255;
      for (int by = y * kCellBlocks; by < std::min(rows, (y + 1) * kCellBlocks); ++by)
        for (int bx = x * kCellBlocks; bx < std::min(columns, (x + 1) * kCellBlocks); ++bx)
          nearest = std::min(
              nearest, blocks[std::size_t(by) * std::size_t(columns) + std::size_t(bx)].nearest);
      cells_[(cell_row0 + std::size_t(y)) * kLayerCells + cell_column0 + std::size_t(x)] = nearest;
    }
}

PictureBlocksView PictureBlocks::view(const AtlasSlot& slot) const {
  const std::size_t block =
      (std::size_t(slot.layer) * kLayerBlocks + std::size_t(slot.y) / kBlockTexels) * kLayerBlocks +
      std::size_t(slot.x) / kBlockTexels;
  const std::size_t cell =
      (std::size_t(slot.layer) * kLayerCells + std::size_t(slot.y) / kCellTexels) * kLayerCells +
      std::size_t(slot.x) / kCellTexels;
  return {&blocks_[block], &cells_[cell], kLayerBlocks, kLayerCells, slot.width, slot.height};
}

}  // namespace rilievo

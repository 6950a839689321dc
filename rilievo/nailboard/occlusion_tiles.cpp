#include "rilievo/nailboard/occlusion_tiles.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {

static_assert(AtlasAllocator::kCell % kCellTexels == 0, "no cell reaches into two pictures");

std::optional<DeltaRange> delta_range(const OcclusionTilesView& blocks) {
  DeltaRange range{2, -1};
  for (int y = 0; y < blocks_across(blocks.height); ++y)
    for (int x = 0; x < blocks_across(blocks.width); ++x) {
      const OcclusionTile& block = blocks.block(x, y);
      if (block.empty()) continue;
      range.nearest = std::min(range.nearest, block.nearest_delta());
      range.farthest = std::max(range.farthest, block.farthest_delta());
    }
  if (range.nearest > range.farthest) return {};
  return range;
}

OcclusionTiles::OcclusionTiles(int layers)
    : blocks_(std::size_t(layers) * kLayerBlocks * kLayerBlocks),
      cells_(std::size_t(layers) * kLayerCells * kLayerCells, 255) {}

std::size_t OcclusionTiles::first_block(const AtlasSlot& slot) {
  return (std::size_t(slot.layer) * kLayerBlocks + std::size_t(slot.y) / kBlockTexels) *
             kLayerBlocks +
         std::size_t(slot.x) / kBlockTexels;
}

std::size_t OcclusionTiles::first_cell(const AtlasSlot& slot) {
  return (std::size_t(slot.layer) * kLayerCells + std::size_t(slot.y) / kCellTexels) * kLayerCells +
         std::size_t(slot.x) / kCellTexels;
}

void OcclusionTiles::assign(const AtlasSlot& slot, std::span<const OcclusionTile> blocks) {
  const int columns = blocks_across(slot.width), rows = blocks_across(slot.height);
  RILIEVO_EXPECTS_EQ(blocks.size(), std::size_t(columns) * std::size_t(rows));
  for (int y = 0; y < rows; ++y)
    std::copy_n(
        blocks.begin() + std::ptrdiff_t(y) * columns, columns,
        blocks_.begin() + std::ptrdiff_t(first_block(slot) + std::size_t(y) * kLayerBlocks));
  for (int y = 0; y < cells_across(slot.height); ++y)
    for (int x = 0; x < cells_across(slot.width); ++x) {
      std::uint8_t nearest = 255;
      for (int by = y * kCellBlocks; by < std::min(rows, (y + 1) * kCellBlocks); ++by)
        for (int bx = x * kCellBlocks; bx < std::min(columns, (x + 1) * kCellBlocks); ++bx)
          nearest = std::min(
              nearest, blocks[std::size_t(by) * std::size_t(columns) + std::size_t(bx)].nearest);
      cells_[first_cell(slot) + std::size_t(y) * kLayerCells + std::size_t(x)] = nearest;
    }
}

OcclusionTilesView OcclusionTiles::view(const AtlasSlot& slot) const {
  return {&blocks_[first_block(slot)],
          &cells_[first_cell(slot)],
          kLayerBlocks,
          kLayerCells,
          slot.width,
          slot.height};
}

}  // namespace rilievo

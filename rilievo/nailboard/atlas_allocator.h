// The places of pictures on the GPU: rectangles of a stack of square layers.
//
// Each layer is a grid of cells. A rectangle takes whole cells, first fit. Pure and deterministic;
// no OpenGL.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace rilievo {

// A rectangle of an atlas.
struct AtlasSlot {
  int layer = 0;
  int x = 0, y = 0;           // texels, a multiple of AtlasAllocator::kCell
  int width = 0, height = 0;  // texels, as requested

  friend bool operator==(const AtlasSlot&, const AtlasSlot&) = default;
};

// Allocates rectangles.
class AtlasAllocator {
 public:
  static constexpr int kCell = 32;  // texels a side
  static constexpr int kLayerSize = 1024;
  static constexpr int kCells = kLayerSize / kCell;  // a side; a row of cells is one 32-bit word

  explicit AtlasAllocator(int layers) : rows_(std::size_t(layers) * kCells, 0u) {}

  // Allocates a rectangle; none if no layer has room. Requires 1 <= width, height <= kLayerSize.
  [[nodiscard]] std::optional<AtlasSlot> allocate(int width, int height);
  // Frees a slot. Requires one that allocate() returned and that is not free.
  void free(const AtlasSlot& slot);

  [[nodiscard]] int layers() const { return int(rows_.size()) / kCells; }
  [[nodiscard]] int free_cells() const;

 private:
  std::vector<std::uint32_t> rows_;  // bit x of row y: cell taken
};

}  // namespace rilievo

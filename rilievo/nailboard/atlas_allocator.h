// Rectangles of texels in a stack of square layers: where pictures live on the GPU.
//
// Every layer is a grid of cells; a rectangle takes whole cells, first fit. Pure and deterministic;
// no OpenGL.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace rilievo {

struct AtlasSlot {
  int layer = 0;
  int x = 0, y = 0;           // texels, a multiple of AtlasAllocator::kCell
  int width = 0, height = 0;  // texels asked for

  friend bool operator==(const AtlasSlot&, const AtlasSlot&) = default;
};

class AtlasAllocator {
 public:
  static constexpr int kCell = 32;  // texels a side
  static constexpr int kLayerSize = 1024;
  static constexpr int kCells = kLayerSize / kCell;  // a side; a row is one 32-bit word

  explicit AtlasAllocator(int layers) : rows_(std::size_t(layers) * kCells, 0u) {}

  // Requires 1 <= width, height <= kLayerSize. Nothing when no layer has room.
  [[nodiscard]] std::optional<AtlasSlot> allocate(int width, int height);
  // Requires a slot that allocate() gave and free() has not taken back.
  void free(const AtlasSlot& slot);

  [[nodiscard]] int layers() const { return int(rows_.size()) / kCells; }
  [[nodiscard]] int free_cells() const;

 private:
  std::vector<std::uint32_t> rows_;  // bit x of row y: cell taken
};

}  // namespace rilievo

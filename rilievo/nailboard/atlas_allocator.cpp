#include "rilievo/nailboard/atlas_allocator.h"

#include <algorithm>
#include <bit>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

int cells_for(int texels) { return (texels + AtlasAllocator::kCell - 1) / AtlasAllocator::kCell; }

std::uint32_t mask_of(int first, int count) {
  return (count == 32 ? ~0u : (1u << count) - 1u) << first;
}

// The lowest x at which `count` consecutive bits of `taken` are clear, or -1.
int find_run(std::uint32_t taken, int count) {
  // After k steps, bit x of `start` says that bits x ... x + k are free.
  std::uint32_t start = ~taken;
  for (int done = 1; done < count && start;) {
    const int step = std::min(done, count - done);
    start &= start >> step;
    done += step;
  }
  // Runs must not leave the row: shifts brought in zeros, which are "taken".
  return start ? std::countr_zero(start) : -1;
}

}  // namespace

std::optional<AtlasSlot> AtlasAllocator::allocate(int width, int height) {
  RILIEVO_EXPECTS(width >= 1 && height >= 1 && width <= kLayerSize && height <= kLayerSize);
  const int columns = cells_for(width), rows = cells_for(height);
  for (int layer = 0; layer < layers(); ++layer) {
    std::uint32_t* const first_row = rows_.data() + layer * kCells;
    for (int y = 0; y + rows <= kCells; ++y) {
      std::uint32_t taken = 0;
      for (int r = 0; r < rows; ++r) taken |= first_row[y + r];
      const int x = find_run(taken, columns);
      if (x < 0) continue;
      for (int r = 0; r < rows; ++r) first_row[y + r] |= mask_of(x, columns);
      return AtlasSlot{layer, x * kCell, y * kCell, width, height};
    }
  }
  return std::nullopt;
}

void AtlasAllocator::free(const AtlasSlot& slot) {
  const std::uint32_t mask = mask_of(slot.x / kCell, cells_for(slot.width));
  for (int r = 0; r < cells_for(slot.height); ++r) {
    std::uint32_t& row = rows_[std::size_t(slot.layer * kCells + slot.y / kCell + r)];
    RILIEVO_EXPECTS((row & mask) == mask);
    row &= ~mask;
  }
}

int AtlasAllocator::free_cells() const {
  int taken = 0;
  for (std::uint32_t row : rows_) taken += std::popcount(row);
  return layers() * kCells * kCells - taken;
}

}  // namespace rilievo

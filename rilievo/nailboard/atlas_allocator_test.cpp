#include "rilievo/nailboard/atlas_allocator.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

namespace rilievo {
namespace {

constexpr int kCell = AtlasAllocator::kCell, kCells = AtlasAllocator::kCells;

// Cells of a slot, by definition.
std::set<std::tuple<int, int, int>> cells_of(const AtlasSlot& slot) {
  std::set<std::tuple<int, int, int>> cells;
  for (int y = slot.y / kCell; y * kCell < slot.y + slot.height; ++y)
    for (int x = slot.x / kCell; x * kCell < slot.x + slot.width; ++x)
      cells.insert({slot.layer, x, y});
  return cells;
}

TEST(AtlasAllocator, slots_never_overlap_and_freed_room_comes_back) {
  std::mt19937 rng(1);
  AtlasAllocator atlas(3);
  std::vector<AtlasSlot> slots;
  std::set<std::tuple<int, int, int>> taken;
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    if (rng() % 5 < 3 || slots.empty()) {
      const int width = 1 + int(rng() % 300), height = 1 + int(rng() % 300);
      const auto slot = atlas.allocate(width, height);
      if (!slot) {
        ++refused;
        // Refused rightly: brute force over every place finds none either.
        const int w = (width + kCell - 1) / kCell, h = (height + kCell - 1) / kCell;
        for (int l = 0; l < 3; ++l)
          for (int y = 0; y + h <= kCells; ++y)
            for (int x = 0; x + w <= kCells; ++x) {
              bool free = true;
              for (int b = 0; b < h && free; ++b)
                for (int a = 0; a < w && free; ++a) free = !taken.contains({l, x + a, y + b});
              ASSERT_FALSE(free);
            }
        continue;
      }
      EXPECT_EQ(slot->width, width);
      EXPECT_LE(slot->x + width, AtlasAllocator::kLayerSize);
      EXPECT_LE(slot->y + height, AtlasAllocator::kLayerSize);
      for (const auto& cell : cells_of(*slot)) ASSERT_TRUE(taken.insert(cell).second);
      slots.push_back(*slot);
    } else {
      const std::size_t k = rng() % slots.size();
      for (const auto& cell : cells_of(slots[k])) taken.erase(cell);
      atlas.free(slots[k]);
      slots.erase(slots.begin() + std::ptrdiff_t(k));
    }
    ASSERT_EQ(atlas.free_cells(), 3 * kCells * kCells - int(taken.size()));
  }
  EXPECT_GT(refused, 10);
}

TEST(AtlasAllocator, a_whole_layer_fits_once) {
  AtlasAllocator atlas(1);
  const auto slot = atlas.allocate(1024, 1024);
  ASSERT_TRUE(slot);
  EXPECT_FALSE(atlas.allocate(1, 1));
  atlas.free(*slot);
  EXPECT_TRUE(atlas.allocate(1, 1));
}

}  // namespace
}  // namespace rilievo

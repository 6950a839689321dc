// A hierarchical z-buffer of two levels: the farthest depth of each block of a picture. What lies
// behind it cannot be seen.
//
// Depth is window_z; infinite where nothing is known. Internal to render/raster.
#pragma once

#include <vector>

#include "rilievo/core/bounds.h"

namespace rilievo {

struct RasterInstance;

// The farthest depths of small and of large blocks of texels. Rows from the bottom.
struct FarthestBlocks {
  static constexpr int kSmall = 8, kLarge = 32;  // texels a side
  // Blocks of one size.
  struct Level {
    int size = 0, columns = 0, rows = 0;
    std::vector<float> depth;

    void begin(int block, int width, int height);
  };
  Level small, large;
  bool any = false;  // is anything known?

  // Nothing is known of a picture of this size.
  void begin(int width, int height);
  // A row of large blocks, from the small ones.
  void update_large(int row);
  void update_any();
};

// Can any triangle in the box (mesh space) be seen in the picture, or is it beside it, behind the
// eye, or behind what blocks show? True where that is not certain.
[[nodiscard]] bool can_be_seen(const RasterInstance& instance, const Box& box,
                               const FarthestBlocks& farthest);

}  // namespace rilievo

// How much does a frame jump against the one before it, where the true frames do not?
//
// Compares two FLIP maps of the change from one frame to the next: that of the true frames and that
// of the method's frames. The excess of the method's change is its own doing: a replaced picture,
// or shimmer. A picture that pops covers a small part of the frame, and a mean over the frame hides
// it; therefore the largest excess over tiles is reported as well.
#pragma once

#include "rilievo/core/image.h"

namespace rilievo {

inline constexpr int kPopTile = 64;  // pixels a side: one degree of the default observer's view

// The excess change of one frame, in units of FLIP (0 to 1).
struct Pop {
  double frame = 0;  // the mean of (method's change - true change), at least 0
  double tile = 0;   // the same over the tile where it is largest
};

// The excess change between two maps of one size, of at least one pixel. Tiles overlap by half. A
// frame smaller than a tile is one tile.
[[nodiscard]] Pop largest_pop(const Image<float>& true_change, const Image<float>& change);

}  // namespace rilievo

// How much does a frame jump against the one before it, where the true frames do not?
//
// From FLIP maps of the change: of the true frames from one to the next, and of the method's. What
// the method's changed more is its own doing: a new picture, or the shimmer of old ones. A picture
// that pops is a small part of the frame, and the mean over the frame hides it; so the largest
// excess over tiles is looked for.
#pragma once

#include "rilievo/core/image.h"

namespace rilievo {

inline constexpr int kPopTile = 64;  // pixels a side, one degree of the default observer's view

struct Pop {
  double frame = 0;  // mean of the method's change less that of the true one; not below 0
  double tile = 0;   // the same over the tile where it is largest
};

// Requires two maps of one size, of at least one pixel. Tiles overlap by half; of a frame smaller
// than a tile the frame is the tile.
[[nodiscard]] Pop largest_pop(const Image<float>& true_change, const Image<float>& change);

}  // namespace rilievo

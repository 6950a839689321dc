// Which rectangles of a slice contain texels? (S2.5)
//
// A slice's own rectangle is tight, but a slanted surface crosses it in a narrow band, so that most
// of a large picture's slices would be empty. Therefore a slice is drawn as a few rectangles of
// whole tiles.
//
// Pure.
#pragma once

#include <vector>

#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Texels a side of a tile.
inline constexpr int kSliceTile = 16;

// For each of the view's slices, disjoint rectangles within Slice::rect that contain each texel
// that the slice shows. The slice's rectangle alone if others would save less than half of it.
[[nodiscard]] std::vector<std::vector<TexelRect>> slice_rects(const LayeredImpostor& impostor,
                                                              int view);

}  // namespace rilievo

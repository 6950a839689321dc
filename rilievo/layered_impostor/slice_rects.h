// Which rectangles of a slice hold texels? (S2.5)
//
// A slice's own rectangle is tight, but a slanted surface crosses it in a narrow band: most of what
// is drawn of a large picture's slices would be empty. So a slice is covered by a few rectangles of
// whole tiles, and drawn through these.
//
// Pure.
#pragma once

#include <vector>

#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Texels a side of a tile.
inline constexpr int kSliceTile = 32;

// For each of the view's slices, rectangles that are disjoint, lie within Slice::rect, and hold
// each texel that the slice shows. The slice's rectangle alone where others would save less than
// half of it.
[[nodiscard]] std::vector<std::vector<TexelRect>> slice_rects(const LayeredImpostor& impostor,
                                                              int view);

}  // namespace rilievo

// The inner loops of filling a nailboard in memory: its rows, and what its cells say.
//
// Internal to the folder. SIMD, chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rilievo {

// What is known of each column within a band of cells, `stride` entries each: the nearest and the
// farthest code, and the least alpha. Columns beyond the picture say nothing: 0xffff, 0, 255.
struct BandColumns {
  std::vector<std::uint16_t> nearest, farthest, alpha;
};

// Copies a row of `width` texels, of which nothing beyond is read, to `color` and `pairs`, rows of
// `stride` texels (a multiple of 16); beyond the width there are no colours. `codes` has `stride`
// entries, beyond the width 0xffff. The columns are those of the band so far, of which this is the
// `first` row or not.
void keep_row(const std::uint32_t* texels, const std::uint16_t* codes, int width, int stride,
              bool first, std::uint32_t* color, std::uint32_t* pairs, BandColumns& columns);

// Of each cell of a band: the nearest code, and whether each texel is opaque, with a code of at
// most `steps`.
void keep_cells(const BandColumns& columns, std::size_t cells, std::uint32_t steps,
                std::uint16_t* nearest, std::uint8_t* opaque);

}  // namespace rilievo

// Which texels of a row may be pinholes (fill_pinholes.h)?
//
// Internal to the folder. SIMD, chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rilievo {

// Writes the columns of those texels of row `y` that have something in front of them, by more than
// `step`, on both sides along the row, the column and each diagonal, and along one of these within
// a gap of at most `widest` texels, whose ends differ by at most `ends`; and, near the picture's
// border, of some others. Returns how many. `delta`: width x height Deltas; `columns`: room for
// `width`.
std::size_t pinhole_candidates(const std::uint16_t* delta, int width, int height, int y, int step,
                               int ends, int widest, std::int32_t* columns);

}  // namespace rilievo

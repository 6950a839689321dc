// Which texels of a row may be pinholes (fill_pinholes.h)?
//
// Internal to the folder. SIMD, chosen at run time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rilievo {

// Writes the columns of those texels of row `y` that lie in a gap of at most `widest` texels along
// the row, the column or a diagonal, whose ends are both in front of it by more than `step`; and,
// near the picture's border, of some others. Returns how many. `delta`: width x height Deltas;
// `columns`: room for `width`.
std::size_t pinhole_candidates(const std::uint16_t* delta, int width, int height, int y, int step,
                               int widest, std::int32_t* columns);

}  // namespace rilievo

// The nearest Delta around each texel of a row: what an empty one beside a silhouette gets.
//
// Internal to the folder. SIMD, chosen at run time.
#pragma once

#include <cstdint>

namespace rilievo {

// Deltas of 16 bits of three rows, `width` texels each: of each texel but the first and the last
// that is empty the least of the nine around it, of others its own. `above` or `below` may be
// `own`.
void nearest_beside(const std::uint16_t* above, const std::uint16_t* own,
                    const std::uint16_t* below, int width, std::uint16_t* codes);

}  // namespace rilievo

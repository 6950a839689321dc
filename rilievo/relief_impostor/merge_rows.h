// What is the inner loop of merge_warps()?
//
// Internal to the folder. SIMD, chosen at run time; every instruction set gives the same bytes.
#pragma once

#include <cstdint>

#include "rilievo/relief_impostor/warp_passes.h"

namespace rilievo {

// 1 / eye_z = first + per_code code, of codes in 16 bits.
struct InverseDepth {
  float first = 0, per_code = 0;
};

// What is merged into rows. A texel (x, y) of the main warp lies in the other one at (u / w, v / w)
// with (u, v, w) = x map[0] + y map[1] + map[2]; what is there at a distance z lies at z / w from
// main's eye.
struct MergeInput {
  float map[3][3] = {};
  // The other warp, with a texel that shows nothing beyond each side; codes with their flags.
  const WarpTexel* other = nullptr;
  int other_pitch = 0;                    // texels from row to row, those beside it included
  int other_width = 0, other_height = 0;  // without
  InverseDepth other_depth, main_depth;
  float share = 0;  // of other's colours, where both show the same surface
};

// A row of the other warp, as MergeInput has it: `to` is the place of its first texel.
void pack_row(const std::uint32_t* color, const std::uint16_t* delta, const std::uint16_t* flags,
              int width, WarpTexel* to);

// Row y of the main warp.
void merge_row(const MergeInput& input, int y, int width, std::uint32_t* color,
               std::uint16_t* delta, std::uint16_t* flags);

}  // namespace rilievo

// Closes pinholes between splats, in the picture that a pre-warp has made.
//
// Surfaces that are steep for the source and turn towards the eye have samples that lie apart, and
// through a gap of a texel or two the far side shows, or nothing. Such a texel lies behind nearly
// all of its neighbours; what is seen through a slit, or past an edge, does not.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/nailboard/prewarped.h"

namespace rilievo {

// Of the eight neighbours, so many lie in front of a pinhole: all around one of two texels.
inline constexpr int kPinholeNeighbors = 7;
// By more than so many texels' widths at the picture's plane.
inline constexpr double kPinholeDepth = 3;

// By how many Deltas of 16 bits is a neighbour in front?
[[nodiscard]] int pinhole_step(const PictureGeometry& geometry);

// Gives each pinhole the colour and the depth of the farthest neighbour that lies in front of it.
// Pictures of identifiers have the same pinholes. `before` is scratch memory.
void fill_pinholes(Prewarped& picture, std::vector<std::uint16_t>& before);

}  // namespace rilievo

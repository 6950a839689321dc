// Closes pinholes between splats, in the picture that a pre-warp has made.
//
// Surfaces that are steep for the source and turn towards the eye have samples that lie apart, and
// through a gap of a few texels the far side shows, or nothing. A texel of such a gap lies behind
// others on both sides along its row, its column and both diagonals, all of them near and each two
// of one surface, and along one of these lines the gap is no longer than neighbouring samples are
// apart: of a hole of its own a surface has samples around it, and wider ones stay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/nailboard/prewarped.h"

namespace rilievo {

// A gap has at most so many texels along each line.
inline constexpr int kPinholeReach = 8;
// Its ends lie in front of it by more than so many texels' widths at the picture's plane, and
// differ by at most so many times as much.
inline constexpr double kPinholeDepth = 3;
inline constexpr int kPinholeEnds = 3;

// By how many Deltas of 16 bits is a neighbour in front?
[[nodiscard]] int pinhole_step(const PictureGeometry& geometry);

// What finding pinholes needs, kept from picture to picture, so that a steady frame allocates
// nothing.
struct PinholeScratch {
  struct Filled {
    std::size_t texel = 0;
    std::uint16_t delta = 0;  // of `from`
    std::size_t from = 0;
    glm::u8vec4 color{0};
  };
  struct Strip {
    std::vector<Filled> filled;
    std::vector<std::int32_t> candidates;  // of a row
  };
  std::vector<Strip> strips;  // as many as any picture had
};

// Gives each texel of a pinhole the colour and the depth of an end of its shortest gap, the farther
// one. `spacing`: neighbouring samples are so many texels apart at the picture's plane; at least 1
// everywhere. Pictures of identifiers have the same pinholes.
void fill_pinholes(Prewarped& picture, double spacing, PinholeScratch& scratch);

}  // namespace rilievo

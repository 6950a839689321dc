// How far does a warp stretch a picture, judged by a few of its texels? (S5.4)
//
// The picture is cut into regions. In each, the critical pair is the two texels beside each other,
// both showing something, whose levels (one over depth) differ most; one pair across and one down.
// Its stretch is the distance between the two after the warp: 1 where nothing is stretched.
// Eqs. (5) to (7) of the paper, for perspective pictures. A heuristic: the pair that is stretched
// most is often, not always, the critical one; true_stretch() looks at all pairs.
#pragma once

#include <optional>
#include <vector>

#include "rilievo/relief_impostor/impostor_warp.h"

namespace rilievo {

// The texel (x, y), and the one to the right of it, or below; their levels.
struct CriticalPair {
  int x = 0, y = 0;
  bool across = true;
  std::uint32_t first = 0, second = 0;
};

// The critical pairs of regions x regions parts of what the picture shows. Regions without pairs
// have none.
[[nodiscard]] std::vector<CriticalPair> critical_pairs(const ImpostorPicture& picture, int regions);

// How far pairs are stretched: eq. (7), and what the paper takes of it.
struct Stretch {
  double mean = 1, most = 1;
};

// Infinite where the warp shows nothing. About 20 ns a pair; allocates nothing.
[[nodiscard]] Stretch stretch_of(const PictureGeometry& picture,
                                 std::span<const CriticalPair> pairs, const PlaneWarp& warp);

// The same of the pairs that are stretched most in each region: slow.
[[nodiscard]] Stretch true_stretch(const ImpostorPicture& picture, int regions,
                                   const PlaneWarp& warp);

}  // namespace rilievo

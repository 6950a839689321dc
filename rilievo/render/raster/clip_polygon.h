// How is a polygon cut at a plane? [Sutherland and Hodgman 1974, Reentrant Polygon Clipping]
#pragma once

#include <cstddef>
#include <vector>

namespace rilievo {

// Keeps the part of a convex polygon for whose corners inside(corner) >= 0; it must be linear. A
// new corner is between(in, out, share), `share` of the way from the corner inside to the one
// outside: in this direction, so that two triangles that share an edge get the same corner there.
// `scratch` is kept by the caller, so that no memory is allocated each time.
template <class Corner, class Inside, class Between>
void clip_polygon(std::vector<Corner>& polygon, std::vector<Corner>& scratch, const Inside& inside,
                  const Between& between) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const auto at_a = inside(a), at_b = inside(b);
    if (at_a >= 0) scratch.push_back(a);
    if ((at_a >= 0) == (at_b >= 0)) continue;
    scratch.push_back(at_a >= 0 ? between(a, b, at_a / (at_a - at_b))
                                : between(b, a, at_b / (at_b - at_a)));
  }
  polygon.swap(scratch);
}

}  // namespace rilievo

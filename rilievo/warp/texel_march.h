// What do the two ray marches through a surface share? Internal to `warp`.
//
// The side of a patch on which a point of the ray lies, and the intersection of ray and patch.
// texel_surface.cpp has the derivation.
#pragma once

#include <algorithm>
#include <array>

#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// The bit of the link from a texel to the neighbour at `step`; -1 if that is not a neighbour.
inline int link_of(const glm::ivec2& step) {
  for (int k = 0; k < 8; ++k)
    if (kLinkSteps[k] == step) return k;
  return -1;
}

// A ray over a surface.
struct TexelMarch {
  const TexelSurface& surface;
  const DisparitySegment& segment;
  double sigma;

  [[nodiscard]] glm::dvec3 at(double t) const { return glm::mix(segment.from, segment.to, t); }
  // Positive in front of the texel's patch.
  [[nodiscard]] double side(const glm::ivec2& texel, double t) const {
    const SurfaceTexel& piece = surface.texels(texel.x, texel.y);
    if (piece.q == 0) return 1;
    const glm::dvec3 p = at(t);
    return sigma * (p.z - surface_q(piece, glm::dvec2(texel) + 0.5, glm::dvec2(p)));
  }
  [[nodiscard]] bool linked(const glm::ivec2& last, const glm::ivec2& texel) const {
    return surface.texels(last.x, last.y).links >> link_of(texel - last) & 1;
  }
  // Crossing the border to a texel at t, from in front of the patch of the one at `last` to behind
  // the other's: do the two pass for one surface there? They are linked, and nearly meet.
  [[nodiscard]] bool meets(const glm::ivec2& last, const glm::ivec2& texel, double t) const {
    return linked(last, texel) && side(last, t) - side(texel, t) <= patch_gap(surface, last);
  }
  // The intersection with the patch between t0 (in front) and t1 (not in front): a line meets a
  // plane in each interval between the texel's middle lines.
  [[nodiscard]] double root(const glm::ivec2& texel, double t0, double t1) const {
    std::array<double, 2> middle;
    for (int a = 0; a < 2; ++a)
      middle[a] = std::clamp((texel[a] + 0.5 - segment.from[a]) / (segment.to[a] - segment.from[a]),
                             t0, t1);
    double s0 = side(texel, t0);
    for (double t : {std::min(middle[0], middle[1]), std::max(middle[0], middle[1]), t1}) {
      if (!(t > t0)) continue;  // also where the segment does not move in u or in v
      const double s = side(texel, t);
      if (s <= 0) return t0 + (t - t0) * s0 / (s0 - s);
      t0 = t, s0 = s;
    }
    return t1;
  }
};

}  // namespace rilievo

// Small scenes that hide things from an eye: solids, plates before bars, combs, fences, leaves.
#pragma once

#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "bench/random.h"

namespace rilievo::bench {

struct GapSolid {
  enum class Kind { ball, box, disc } kind = Kind::ball;
  glm::dvec3 center{0.0};
  double radius = 1;     // ball, disc
  glm::dmat3 axes{1.0};  // columns, orthonormal; box: along its edges; disc: the third its normal
  glm::dvec3 half{1.0};  // box
};

struct GapScene {
  std::vector<GapSolid> solids;

  // The first and the last surface along origin + t direction, t > 0. False: none.
  [[nodiscard]] bool cast(const glm::dvec3& origin, const glm::dvec3& direction, double& first,
                          double& last) const;
  // Half the edge of a cube around the origin that holds everything.
  [[nodiscard]] double reach() const;
};

inline constexpr std::string_view kGapScenes[] = {
    "ball",  "box",    "box seen flat", "plate before bars", "plate hides bars", "comb",
    "fence", "leaves", "tree",          "balls on ground",   "pillars",          "plates"};

// A random scene of this kind around the origin, some metres across. Made to be looked at along z.
[[nodiscard]] GapScene make_gap_scene(std::size_t kind, SplitMix64& random);

}  // namespace rilievo::bench

// Several layered reliefs of one object, and the one for an eye (S4.4).
//
// A relief seen from beside stretches: its rectangle grows with the tangent of the angle, and its
// texels with it. Reliefs from several directions are kept, and the one whose direction is nearest
// to the eye's is warped.
#pragma once

#include <span>
#include <vector>

#include "rilievo/capture/view_set.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

struct ReliefSet {
  std::vector<LayeredRelief> reliefs;
};

// How many texels, across and down together as areas, the rectangle has for each of the source's
// that the relief covers, seen from `eye`; infinite if it cannot be warped from there.
[[nodiscard]] double relief_stretch(const LayeredRelief& relief, const glm::dvec3& eye);

// The relief that faces the eye most, of those that it stands in front of; -1 if there is none.
// `current`, the one shown now (or -1), stays unless another one faces the eye by more than
// `hold` radians better: no flicker where two are alike.
[[nodiscard]] int pick_relief(const ReliefSet& set, const glm::dvec3& eye, int current = -1,
                              double hold = 0.05);

// 1: along +z; 2: both ways; 6: along all axes, both ways; 12, 20, 32: as view_set.h spreads them.
// Directions are from the object towards the viewer. The error says which numbers there are.
[[nodiscard]] Result<std::vector<glm::dvec3>> relief_directions(int count);

struct ReliefBakeOptions {
  int size = 512;              // texels of the longer side; texels are square
  double merge_texels = 0.01;  // samples closer along a ray than that share of a texel become one
  LayeredReliefOptions relief;
};

// A parallel camera around `box` that looks at it from `direction`.
[[nodiscard]] Result<Camera> relief_camera(const Box& box, const glm::dvec3& direction, int size);

// All that `scene` holds, by rays.
[[nodiscard]] Result<ReliefSet> bake_reliefs(const RayScene& scene,
                                             std::span<const glm::dvec3> directions,
                                             const ReliefBakeOptions& options = {});

}  // namespace rilievo

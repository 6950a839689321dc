// Which of several layered reliefs of an object is warped for an eye? (S4.4)
//
// Seen from the side, a relief stretches: its rectangle and its texels grow with the tangent of the
// angle. A set holds reliefs from several directions, and the one nearest to the eye's direction is
// warped.
#pragma once

#include <span>
#include <vector>

#include "rilievo/capture/view_set.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// Reliefs of one object.
struct ReliefSet {
  std::vector<LayeredRelief> reliefs;
};

// The area of the rectangle seen from `eye` relative to the area that the relief covers in the
// source; infinite if it cannot be warped from there.
[[nodiscard]] double relief_stretch(const LayeredRelief& relief, const glm::dvec3& eye);

// The index of the relief that faces the eye most, among those that the eye is in front of; of
// none, the first that can be warped in part; -1 if there is none. To prevent flicker, `current`
// (the relief shown now, or -1) stays unless another one faces the eye better by more than `hold`
// radians.
[[nodiscard]] int pick_relief(const ReliefSet& set, const glm::dvec3& eye, int current = -1,
                              double hold = 0.05);

// Unit directions from the object towards the viewer. 1: along +z; 2: along +z and -z; 6: along all
// axes; 12, 20, 32: as view_set.h distributes them. The error names the allowed numbers.
[[nodiscard]] Result<std::vector<glm::dvec3>> relief_directions(int count);

// The resolution of a bake.
struct ReliefBakeOptions {
  int size = 512;              // texels of the longer side; texels are square
  double merge_texels = 0.01;  // samples within this share of a texel along a ray become one
  double ball = 0;             // as for relief_camera
  LayeredReliefOptions relief;
};

// A parallel camera around `box` whose viewers are in `direction`; `size` texels on the longer
// side. ball > 0: a square, so many times as wide as the ball around the box, so that texels are of
// one size from all directions. At least 1.
[[nodiscard]] Result<Camera> relief_camera(const Box& box, const glm::dvec3& direction, int size,
                                           double ball = 0);

// How many times as large as the others' are the splats of a relief with finer texels? Other
// textures' samples lie as far apart as their texels, of which the largest has the side `largest`;
// its own are as fine as `texel`, and so are the details that splats must not hide:
//
//   sqrt(min(2, largest / texel))
[[nodiscard]] double relief_splat_scale(double texel, double largest);

// Bakes the whole scene by ray casting, one relief for each direction.
[[nodiscard]] Result<ReliefSet> bake_reliefs(const RayScene& scene,
                                             std::span<const glm::dvec3> directions,
                                             const ReliefBakeOptions& options = {});

}  // namespace rilievo

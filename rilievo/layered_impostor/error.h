// How far from where it belongs does a layered impostor show what it shows?
//
// What is known of an object are its pictures' samples, one in the middle of every texel, and the
// pieces of surface spanned between them (texel_surface.h). A warp shows a piece beside its place:
//
//   slices    draw the texel on a quad that its interval reaches: the point drawn is off by up to
//             half of the slice's interval (overlap included) along the picture's line of sight,
//             and lies within the texel across it
//   surfaces  meet the piece itself
//
// and a piece is off the nearest sample by up to half the step to the next one. Two bounds follow:
// how far a point drawn lies from the surface that it shows (nothing for the walk), and from the
// sample that it shows, which is a point of the true surface: the bound to keep. It holds for every
// view, so that it does not matter which ones serve the eye.
//
// Not bounded is what shows where no picture holds the surface: skins and the inside (inside.h).
// Rounding of the GPU's floats is not counted. Pure, any thread.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Largest over an impostor's texels, metres of the world in which its pictures were taken.
struct LayeredErrorFigures {
  double slice = 0;  // from a slice to an end of its interval, along the line of sight
  double reach = 0;  // from a sample to an end of its piece, along the line of sight
  double texel = 0;  // from the middle of a texel to its corner
};
// Looks at every texel: once for an impostor, not in every frame.
[[nodiscard]] LayeredErrorFigures layered_error_figures(const LayeredImpostor& impostor);

// Upper bounds over everything that the impostor draws into the frame. Pixels are infinite where
// the eye is so near that there is no bound.
struct LayeredError {
  double surface_m = 0, sample_m = 0;    // metres of the frame's world: on the screen and in depth
  double surface_px = 0, sample_px = 0;  // between where a point is drawn and where it belongs
  // As PictureError::total_px, for every pixel centre q that shows a sample, whose position
  // projects to s: |q - s| <= total_px + sqrt(1/2). That is the sample's slice and its texel, but
  // not how far its piece stretches towards the next sample, where a flat picture leaves a gap.
  double total_px = 0;
};

// O(1). `bounds` are the impostor's; `world_from_impostor` as in drawing, a rigid motion or uniform
// scale. Requires a perspective camera.
[[nodiscard]] LayeredError bound_layered_error(const LayeredErrorFigures& figures, bool sliced,
                                               const Box& bounds,
                                               const glm::dmat4& world_from_impostor,
                                               const Camera& frame);

// Eyes too near to the centre see sides of the object for which the pictures nearest to them were
// not made, and which may be in none.
[[nodiscard]] bool is_served(const Box& bounds, const glm::dmat4& world_from_impostor,
                             const Camera& frame);

// The bound for every frame of `frame`'s size and field of view whose eye is at least `distance`
// metres from the box.
[[nodiscard]] LayeredError bound_layered_error_from(const LayeredErrorFigures& figures, bool sliced,
                                                    const Camera& frame, double distance);

}  // namespace rilievo

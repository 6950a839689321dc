// How far from its true place does a layered impostor show a point?
//
// An object is known by its pictures' samples, one at the centre of each texel, and by the surface
// patches spanned between them (texel_surface.h). Drawing displaces a patch:
//
//   slices    draw the texel on a quad that its interval reaches: the point is off by up to half of
//             the slice's interval (overlap included) along the picture's line of sight, and lies
//             within the texel across it
//   surfaces  intersect the patch itself
//
// A patch differs from the nearest sample by up to half the step to the next sample. Three bounds
// follow: the distance of a drawn point from the surface that it shows (0 for `surfaces`), from the
// sample that it shows, and from the source of its colour (angular_error.h): that sample, or where
// `surfaces` interpolate, the mean position of the samples. Samples are points of the true surface,
// so the last is the bound to use. The first two hold for every view, the last for those that are
// drawn.
//
// Points and lines count with their size: the nearest pictures may see a disc from any side, and a
// strip of texels is wider than one of pixels.
//
// Not bounded: pixels where no picture has the surface, that is skins and the visual hull
// (visual_hull.h). Rounding errors of the GPU are not included. Pure, any thread.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/layered_impostor/angular_error.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// The largest values over an impostor's texels, metres of the world at capture. Plain data.
struct LayeredErrorStats {
  bool sliced = false;
  double slice = 0;  // from a slice to an end of its interval, along the line of sight
  double reach = 0;  // from a sample to an end of its patch, along the line of sight
  double texel = 0;  // from the centre of a texel to its corner
  StrokeSize strokes;
  AngularErrorTable angular;
};
// Computes them for what is drawn with these options. Looks at each texel: call it once for an
// impostor, not in each frame.
[[nodiscard]] LayeredErrorStats layered_error_stats(const LayeredImpostor& impostor,
                                                    const LayeredOptions& options);

// Upper bounds over everything that the impostor draws into the frame. Pixels are infinite for eyes
// too near for a bound.
struct LayeredError {
  double surface_m = 0, sample_m = 0;    // in the frame's world, on the screen and in depth
  double surface_px = 0, sample_px = 0;  // between the drawn and the true position of a point
  // As PictureError::total_px: for each pixel centre q, and s where the source of its colour
  // projects to, |q - s| <= total_px + sqrt(1/2). Infinite for eyes that are not served.
  double total_px = 0;
};

// The bounds in a frame; O(1). `bounds` are the impostor's; `world_from_impostor` is a rigid motion
// or uniform scale, as in drawing. Requires a perspective camera.
[[nodiscard]] LayeredError bound_layered_error(const LayeredErrorStats& stats, const Box& bounds,
                                               const glm::dmat4& world_from_impostor,
                                               const Camera& frame);

// The bounds over all frames of `frame`'s size and field of view whose eye is at least `distance`
// metres from the box.
[[nodiscard]] LayeredError bound_layered_error_from(const LayeredErrorStats& stats,
                                                    const Box& bounds, const Camera& frame,
                                                    double distance);

}  // namespace rilievo

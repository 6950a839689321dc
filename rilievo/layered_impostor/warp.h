// What does a layered impostor look like from a new eye?
//
// Both ways of drawing it, on the CPU and pixel by pixel: the reference for the OpenGL drawer, and
// the means to find holes without one. A frame shows the picture nearest to the viewer's direction;
// where that has holes, it shows other pictures (S2.6).
//
// Output: colour, eye_z, and in `object` the pictures' identifiers if they have any, else 1. The
// result does not depend on the number of threads.
#pragma once

#include <span>
#include <vector>

#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// A slice to draw, explicitly chosen.
struct SliceDraw {
  int view = 0;
  int slice = 0;   // index into LayeredImpostor::slices[view]
  TexelRect rect;  // the part to draw
};

// Draws an explicit list of slices with a depth buffer: a pixel shows the nearest slice whose quad
// has a texel under the pixel's centre. If `drawn` is given, it receives the index of the draw that
// each pixel shows, or -1. Requires a perspective camera.
[[nodiscard]] DepthImage warp_slices(const LayeredImpostor& impostor,
                                     std::span<const SliceDraw> draws, const Camera& camera,
                                     Image<int>* drawn = nullptr);

// Appends the slices of `view` for this eye: all of its own, nearest to the eye first if the eye is
// on the side of the picture's viewers; with `fill`, also slices that fill its holes from the two
// other views of the triangle around the direction (all of their slices, if fill slices have not
// been computed).
void slices_of_view(const LayeredImpostor& impostor, int view, const glm::dvec3& eye, bool fill,
                    std::vector<SliceDraw>& draws);

// The same for the view nearest to the eye's direction.
[[nodiscard]] std::vector<SliceDraw> slices_for_eye(const LayeredImpostor& impostor,
                                                    const glm::dvec3& eye, bool fill);

// How many pictures a pixel looks up, and how they fade.
struct SurfaceWarpOptions {
  // Pictures looked up, 1 to kMaxViewsAsked; with 1, holes stay open.
  int max_views = kMaxViewsAsked;
  double handover = kHandover;  // 0: views switch
};

// Draws by height-field ray march, without slices: each pixel's ray is intersected with the
// surfaces of the nearest views.
//
// A view's answer is certain if the ray did not pass behind an edge and the view either has a hit
// or is complete there (LayeredImpostor::complete). Certain answers of the views with weight
// (handover_weights) are blended; where some have a hit and others have none, the weighted majority
// decides. If those that are certain have less weight together than kSureWeight, other views near
// the eye's direction are looked up until one is certain, and has what lacks of that weight; those
// first that look along the pixel's ray, as an eye beside an object sees its sides from other
// directions than its middle, and only as long as they do so more than those with weight that are
// certain: so nothing changes at once where a view begins to fade in.
//
// A view that is not certain knows the ray as far as its first edge, and again from where the ray
// came out in front after the last one (SurfaceHit::behind_from, behind_to). Where another view
// knows it as far as there, what the first one says is certain.
//
// If none is certain, nothing is shown where a view sees through (LayeredImpostor::sees_through),
// else the hit nearest to the eye. If there is no hit either, and in most views the ray passed
// behind one part of the surface in front of another, and not behind an outline, the pixel lies
// within the object: it shows a skin between the two parts, with the colour of the farther one.
//
// Requires a perspective camera.
[[nodiscard]] DepthImage warp_surfaces(const LayeredImpostor& impostor, const Camera& camera,
                                       const SurfaceWarpOptions& options = {});

// The eyes that look for holes.
struct FillOptions {
  double distance = 4.0;  // in radii of the bounds
  int size = 64;          // of their frames, pixels
};

// Finds the fill slices of every ordered pair of neighbouring views (S2.6). Eyes on the border of
// the region that the view serves, where its holes are widest, draw the texels' identifiers:
// between the two views, and between them and each third view of a triangle. Where the view's
// answer is not certain, the neighbour's slices that hold the visible texel are kept.
void find_fill_slices(LayeredImpostor& impostor, const FillOptions& options = {});

}  // namespace rilievo

// What does a layered impostor look like from a new eye?
//
// The two ways to draw it, on the CPU, pixel by pixel and by definition: what the OpenGL drawer is
// tested against, and how holes are found without one. A frame shows the picture nearest to the
// viewer's direction, and through its holes others, that see there what it does not (S2.6).
//
// Output: colour, eye_z, and in `object` the picture's objects where it has them, else 1. Same
// bytes for any number of threads.
#pragma once

#include <span>
#include <vector>

#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Whichever slices of whichever pictures: no choice is made here.
struct SliceDraw {
  int view = 0;
  int slice = 0;   // index into LayeredImpostor::slices[view]
  TexelRect rect;  // the part of it to draw
};

// Draws slices with a depth buffer: a pixel shows, of the slices' quads under its centre that hold
// a texel there, the nearest. For each pixel also which draw it shows, -1 for none, if `drawn` is
// given. Requires a perspective camera.
[[nodiscard]] DepthImage warp_slices(const LayeredImpostor& impostor,
                                     std::span<const SliceDraw> draws, const Camera& camera,
                                     Image<int>* drawn = nullptr);

// The slices that `view` takes to serve this eye, appended: all of its own, nearest to the eye
// first where it looks as the picture's viewers do; with `fill` also those that fill its holes, of
// the two others of the triangle around the direction (or all of theirs, if none have been found
// yet).
void slices_of_view(const LayeredImpostor& impostor, int view, const glm::dvec3& eye, bool fill,
                    std::vector<SliceDraw>& draws);

// The same of the view nearest to the eye's direction.
[[nodiscard]] std::vector<SliceDraw> slices_for_eye(const LayeredImpostor& impostor,
                                                    const glm::dvec3& eye, bool fill);

struct SurfaceWarpOptions {
  int max_views = 6;            // pictures asked, 1 to 6; 1 shows the holes
  double handover = kHandover;  // 0: views switch
};

// The second way, which does not slice: every pixel's ray is intersected with the surfaces of the
// nearest views. Those with a weight (handover_weights) are blended where they answer for certain:
// with a hit, or with nothing (LayeredImpostor::complete), without having passed behind an edge;
// where some see a surface and
// others past it, the more weighty party wins. If none is certain, the next nearest views are asked
// until one is. If none is, the hit nearest to the eye counts; if there is no hit, and the ray was
// lost behind one part of the surface in front of another in more of them than behind an outline,
// the pixel is within the object: it shows a skin between the two, in the colour of the farther.
// Requires a perspective camera.
[[nodiscard]] DepthImage warp_surfaces(const LayeredImpostor& impostor, const Camera& camera,
                                       const SurfaceWarpOptions& options = {});

struct FillOptions {
  double distance = 4.0;  // of the eyes that look for holes, in radii of the bounds
  int size = 128;         // of their frames, pixels
};

// Finds the fill slices of every ordered pair of neighbouring views (S2.6). Eyes on the border of
// the region that the view serves, where its holes are widest, draw the texels' identifiers:
// between the two views, and between them and each third view of a triangle. Where the view's
// surface does not answer for certain, the slices that hold the neighbour's texel are kept.
void find_fill_slices(LayeredImpostor& impostor, const FillOptions& options = {});

}  // namespace rilievo

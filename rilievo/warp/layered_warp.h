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

#include "rilievo/represent/layered_impostor.h"

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

// The slices that serve this eye: all of the nearest view's; with `fill` also the fill slices of
// the two others, or all of theirs if none have been found yet.
[[nodiscard]] std::vector<SliceDraw> slices_for_eye(const LayeredImpostor& impostor,
                                                    const glm::dvec3& eye, bool fill);

// The second way, which does not slice: every pixel's ray is intersected with the surfaces of the
// `max_views` nearest views in turn. The first that answers for certain is believed: a hit, or
// nothing, without having passed behind an edge. If none does, the hit nearest to the eye counts.
// 1 shows the holes. Requires a perspective camera and max_views >= 1.
[[nodiscard]] DepthImage warp_surfaces(const LayeredImpostor& impostor, const Camera& camera,
                                       int max_views = 6);

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

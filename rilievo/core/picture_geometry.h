// Where was a flat picture with depth taken, and where does its polygon stand?
//
// The polygon is the capture camera's image window on the plane eye_z == plane_z in front of the
// capturing eye. Everything that draws a picture or bounds its error speaks of it in these terms.
#pragma once

#include "rilievo/core/camera.h"

namespace rilievo {

// How a picture writes the z-buffer.
enum class DepthMode {
  flat,    // the polygon's own depth: the flat impostor, the thing to beat
  linear,  // eq. (4) of [Schaufler 1997]: z_N + (z_F - z_N) Delta, no division (S1.3)
  exact,   // section 3: un-projected, transformed, projected (S1.2)
};

// Between which distances from the capture eye lie a picture's samples? 0 < front <= back.
struct DepthSlab {
  double front = 1, back = 1;
  friend bool operator==(const DepthSlab&, const DepthSlab&) = default;
};

struct PictureGeometry {
  Camera capture;      // perspective; its frustum holds all samples
  double plane_z = 1;  // where the polygon stands: eye_z of the capture, slab.front ... slab.back
  DepthSlab slab;      // of the samples; may be tighter than the capture's z_near ... z_far
  int delta_bits = 0;  // 2 ... 16 (see core/depth.h); 0: depth is not quantised
  DepthMode depth_mode = DepthMode::exact;
};

// The plane with the least parallax for every sample of the slab: the nearest and the farthest
// sample slide equally far. Within [front, back].
[[nodiscard]] double best_plane(DepthSlab slab) noexcept;

// A picture of all that `capture` may see between its z_near and z_far, on the best plane.
[[nodiscard]] PictureGeometry picture_geometry(const Camera& capture);

// Deltas of a picture's nearest and farthest sample, 0 <= nearest <= farthest <= 1.
struct DeltaRange {
  double nearest = 0, farthest = 1;
  friend bool operator==(const DeltaRange&, const DeltaRange&) = default;
};

// The distances with Deltas `range` of the frustum between `whole`.
[[nodiscard]] DepthSlab part_of(DepthSlab whole, const DeltaRange& range);

// Its samples turned out to have these Deltas, before they were rounded to delta_bits or after:
// narrows the slab to them and moves the polygon to its best plane.
void narrow_slab(PictureGeometry& picture, DeltaRange range);

}  // namespace rilievo

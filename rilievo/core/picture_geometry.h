// The geometry of a flat picture with depth: its camera, and where its polygon stands.
//
// The polygon is the capture camera's image window on the plane eye_z == plane_z in front of the
// capture eye. Drawing, warping and error bounds all describe a picture in these terms.
#pragma once

#include "rilievo/core/camera.h"
#include "rilievo/core/stroke_size.h"

namespace rilievo {

// How a picture writes the z-buffer.
enum class DepthMode {
  flat,    // the depth of the polygon itself: a flat impostor, the baseline
  linear,  // eq. (4) of [Schaufler 1997]: z_N + (z_F - z_N) Delta, no division (S1.3)
  exact,   // the same, section 3: un-projected, transformed and projected (S1.2)
};

// The interval of distances from the capture eye (eye_z, metres) that holds a picture's samples.
// Requires 0 < front <= back.
struct DepthSlab {
  double front = 1, back = 1;
  friend bool operator==(const DepthSlab&, const DepthSlab&) = default;
};

// The geometry of a flat picture with depth: capture camera, polygon and depth encoding.
struct PictureGeometry {
  Camera capture;      // perspective; its frustum holds all samples
  double plane_z = 1;  // eye_z of the polygon in the capture's eye space, slab.front ... slab.back
  DepthSlab slab;      // holds the samples; can be tighter than the capture's z_near ... z_far
  int delta_bits = 0;  // 2 ... 16 (see core/depth.h); 0: depth is not quantised
  DepthMode depth_mode = DepthMode::exact;
  StrokeSize strokes;  // the largest of the points and lines that it shows
};

// The plane with the least parallax over the slab, at which the nearest and the farthest sample
// slide equally far. Lies within [front, back].
[[nodiscard]] double best_plane(DepthSlab slab) noexcept;

// The geometry of a picture of everything between `capture`'s z_near and z_far, on the best plane.
[[nodiscard]] PictureGeometry picture_geometry(const Camera& capture);

// Deltas of a picture's nearest and farthest sample, 0 <= nearest <= farthest <= 1.
struct DeltaRange {
  double nearest = 0, farthest = 1;
  friend bool operator==(const DeltaRange&, const DeltaRange&) = default;
};

// The part of `whole` that lies between two Deltas; `whole` is the frustum that the Deltas refer
// to.
[[nodiscard]] DepthSlab part_of(DepthSlab whole, const DeltaRange& range);

// Narrows the slab to the Deltas that the samples were found to have (before or after rounding to
// delta_bits), and moves the polygon to the best plane of the narrowed slab.
void narrow_slab(PictureGeometry& picture, DeltaRange range);

}  // namespace rilievo

// Are the depths of a foreign renderer along its axis or along its rays? Two pictures tell.
//
// Renderers differ, and so do versions of one. From one eye, two pictures are taken that look in
// different directions: a surface that both see is equally far from the eye in both. Where the
// depths are eye_z, that distance is z / cos(angle between ray and axis), and differs by up to a
// fourth from z, in opposite directions in the two pictures.
#pragma once

#include <optional>

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// How often distances agree if depths are taken as one kind or the other.
struct DepthKindVotes {
  int texels = 0;                      // seen by both pictures
  double off_eye_z = 0, off_ray = 0;   // median relative difference of the distances
  std::optional<DepthKind> kind = {};  // none: too few texels, or neither is clearly better
};

// From two pictures of one eye, whose depths are as the renderer wrote them (as if eye_z).
[[nodiscard]] DepthKindVotes compare_depth_kinds(const DepthImage& a, const DepthImage& b);

// Takes such pictures of `source`, which must take depths as eye_z, inside of its bounds and, if
// that is not enough, outside of them. Fails where the source does, or if nothing can be told.
[[nodiscard]] Result<DepthKind> find_depth_kind(CaptureSource& source);

}  // namespace rilievo

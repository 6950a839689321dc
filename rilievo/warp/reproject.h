// How do photographs with depth become the pictures of a representation? (S2.7)
//
// Each target camera is shown what all photographs together know of a box: they are taken apart
// into triangles between linked texels (warp/texel_links.h), so that there are no cracks within a
// surface and no skin over its edges, and the triangles are drawn into the target. A triangle has
// one side, that which its photograph saw: a target whose viewers look at its back does not show
// it. Where several photographs know the same piece of surface, they are averaged, each by the
// square of how densely its samples lie on it: the one from nearby and straight on counts most.
//
// Photographs: perspective, depth of any kind. Targets: perspective (nearest surface shown) or
// back-perspective (farthest from the apex). World space, metres. Same bytes for any number of
// threads.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {

struct ReprojectOptions {
  // Only triangles with all corners in it. Must not be empty.
  Box box;
  LinkOptions links;
  // Samples on a target's ray show one surface if they are no farther apart than this share of
  // their distance to their own photograph: what its depths, and poses, are trusted to.
  double depth_error = 0.02;
  // At so many places along a ray it is asked whether a photograph saw through.
  int hole_steps = 48;
};

// Texels of one target, or of all.
struct ReprojectFigures {
  std::size_t filled = 0;
  // Nothing is shown, and something may be there: of the stretch of the texel's ray within the box,
  // not every place is known to be empty. A photograph knows a place to be empty if it measured
  // something behind it, or is masked out there.
  std::size_t holes = 0;
  // Holes within the silhouette, which is both together.
  [[nodiscard]] double hole_share() const {
    return filled + holes == 0 ? 0.0 : double(holes) / double(filled + holes);
  }
};

struct Reprojection {
  // One a target, of eye_z; may be empty of samples. A hole has no depth, but colour 0 0 0 1, from
  // which a layered impostor knows that it cannot rely on nothing being there.
  std::vector<DepthImage> pictures;
  std::vector<ReprojectFigures> figures;  // one a target
  ReprojectFigures total;
};

// Requires valid cameras of the kinds above.
[[nodiscard]] Reprojection reproject(std::span<const DepthImage> photographs,
                                     std::span<const Camera> targets,
                                     const ReprojectOptions& options);

// The box around all that is measured, but for the outermost `outliers` share of the samples along
// each axis and to either side. Empty if nothing is.
[[nodiscard]] Box measured_bounds(std::span<const DepthImage> photographs, double outliers = 0.001);

}  // namespace rilievo

// How do photographs with depth become the pictures of a representation? (S2.7)
//
// Each target camera gets what all photographs together know of a box. Each photograph is split
// into triangles between linked texels (warp/texel_links.h), so that there are neither cracks
// within a surface nor skins over its edges; the triangles are drawn into the target. A triangle
// has one side, the one that its photograph saw: it is not drawn for a target that sees its back.
// Where several photographs know the same piece of surface, their colours are averaged, weighted by
// the square of their sampling density on it: near and perpendicular views count most.
//
// Photographs: perspective, depth of any kind. Targets: perspective (nearest surface shown) or
// back-perspective (farthest from the apex). World space, metres. The result does not depend on the
// number of threads.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/warp/texel_links.h"

namespace rilievo {

// What to reproject, and how much the photographs can be trusted.
struct ReprojectOptions {
  // Only triangles with all corners in the box are drawn. Must not be empty.
  Box box;
  LinkOptions links;
  // The accuracy of depths and poses. Samples on a target's ray belong to one surface if they
  // differ by at most this share of their distance from their own photograph.
  double depth_error = 0.02;
  // The number of places on a ray that are tested for free space.
  int hole_steps = 48;
};

// Numbers of texels of one target, or of all.
struct ReprojectStats {
  std::size_t filled = 0;
  // Texels that show nothing although something may be there: not every place on the texel's ray
  // within the box is known to be free. A photograph knows a place to be free if it measured a
  // surface behind it or masks it out.
  std::size_t holes = 0;
  // The share of holes in the silhouette (filled + holes).
  [[nodiscard]] double hole_share() const {
    return filled + holes == 0 ? 0.0 : double(holes) / double(filled + holes);
  }
};

// The pictures, one for each target.
struct Reprojection {
  // Of eye_z; a picture can be empty. A hole has no depth, but colour 0 0 0 1, so that free-space
  // carving does not take it for empty.
  std::vector<DepthImage> pictures;
  std::vector<ReprojectStats> stats;  // one for each target
  ReprojectStats total;
};

// Reprojects the photographs into all targets. Requires valid cameras of the kinds named above.
[[nodiscard]] Reprojection reproject(std::span<const DepthImage> photographs,
                                     std::span<const Camera> targets,
                                     const ReprojectOptions& options);

// The box around all measured samples, without the outermost share `outliers` of them at either end
// of each axis. Empty if nothing was measured.
[[nodiscard]] Box measured_bounds(std::span<const DepthImage> photographs, double outliers = 0.001);

}  // namespace rilievo

// Which samples can reach a tile of the result, and in which order must they be drawn? (S4.6)
//
// Internal to the folder. The epipole's row and column divide the source into at most four sheets;
// each is drawn towards the epipole. Within a sheet, the quad-tree is traversed with the children
// farther from the epipole first. This is correct because whatever hides a sample is, in both u and
// v, at least as near to the epipole, and this order (Z-order) never visits the farther one last.
// Where k3 < 0 it is at least as far, and all is drawn away from the epipole.
#pragma once

#include <cmath>
#include <vector>

#include "rilievo/layered_relief/prewarp_kernels.h"

namespace rilievo {

// Columns [u_from, u_to) and rows [v_from, v_to) of the source, drawn in one order.
struct Sheet {
  int u_from = 0, u_to = 0, v_from = 0, v_to = 0;
  unsigned order = 0;
};
// The sheets that contain texels.
[[nodiscard]] std::vector<Sheet> sheets_of(const LayeredRelief& relief, const ReliefWarp& warp);

// A rectangle of the result and the reach of samples beyond their texels' centres, in source
// texels.
struct RunQuery {
  glm::dvec2 min{0.0}, max{0.0};
  double half_splat = 0.5;
  // Of lines of sight against the plane's axis, for each texel from the epipole, and at most. Where
  // it is not 0, splats face the eye.
  glm::dvec2 slope_per_texel{0.0};
  double most_slope = 0;
  double resolution = 1;  // of the result; decides how many texels a splat covers
  bool nearest = false;
  std::uint32_t least_code = 0;  // nearer samples are not drawn
};

// How much wider on the plane is a splat that faces the eye? A line of sight with slope t against
// the plane's axis sees what lies on the plane, along this slope, shortened to cos(atan t):
//
//   stretch = sqrt(1 + t^2)
[[nodiscard]] inline double splat_stretch(double slope) { return std::sqrt(1 + slope * slope); }

// Appends the runs that can reach the rectangle, in drawing order.
void find_runs(const LayeredRelief& relief, const ReliefWarp& warp,
               const std::vector<Sheet>& sheets, const RunQuery& query,
               std::vector<PrewarpRun>& runs);

}  // namespace rilievo

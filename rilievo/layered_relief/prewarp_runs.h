// Which samples may reach a tile of the result, and in which order must they be drawn? (S4.6)
//
// Internal to the folder. The epipole's row and column divide the source into up to four sheets;
// each is drawn towards the epipole. Within a sheet the quad-tree is descended, children farther
// from the epipole first: whatever hides something lies, in both u and v, at least as near to the
// epipole as what it hides, and such an order (Z-order) never puts the farther one last.
#pragma once

#include <array>
#include <vector>

#include "rilievo/layered_relief/prewarp_kernels.h"

namespace rilievo {

// Columns [u_from, u_to) and rows [v_from, v_to) of the source, drawn in one order.
struct Sheet {
  int u_from = 0, u_to = 0, v_from = 0, v_to = 0;
  unsigned order = 0;
};
// Those with texels in them.
[[nodiscard]] std::vector<Sheet> sheets_of(const LayeredRelief& relief, const ReliefWarp& warp);

// A rectangle of the result in source texels, and how far samples reach beyond their texels'
// centres, also in source texels.
struct RunQuery {
  glm::dvec2 min{0.0}, max{0.0};
  double half_splat = 0.5;
  double resolution = 1;  // of the result, to know how many texels a splat covers
  bool nearest = false;
};

struct RunRange {
  std::uint32_t nearest = kEmptyCode, farthest = 0;  // codes of all runs; empty as in ReliefNode
};

// Appends to `runs`, in drawing order.
RunRange find_runs(const LayeredRelief& relief, const ReliefWarp& warp,
                   const std::vector<Sheet>& sheets, const RunQuery& query,
                   std::vector<PrewarpRun>& runs);

}  // namespace rilievo

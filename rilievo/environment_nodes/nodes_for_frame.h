// Which nodes does a frame show? (S3.8)
//
// The best for its eye (nodes_for_eye), and where these together lack something of the view, one
// more that holds most of it. What the eye sees is found by the nodes' sketches alone, so that the
// choice follows from nodes and frame, whatever is in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/environment_nodes/environment_nodes.h"
#include "rilievo/environment_nodes/node_store.h"

namespace rilievo {

// Nodes in the order in which they are wanted; the first `drawn` are shown.
struct FrameNodes {
  std::vector<std::size_t> order;
  std::size_t drawn = 0;
  // If one more than `merged` is drawn: where it holds what the others lack.
  FrameParts filled{};
};
// Chooses `merged` nodes (at least one), and one more if `fills` and it holds so much of the view
// that the others do not: kLeastFilled of it, times the root of how many times as far it is as the
// last of them. Adds none to frames of a parallel projection.
[[nodiscard]] FrameNodes nodes_for_frame(const EnvironmentNodes& nodes, const Camera& frame,
                                         std::size_t merged, bool fills);
inline constexpr double kLeastFilled = 0.003;

// What the eye sees on a line of sight.
struct SeenPlace {
  double distance = 0;     // 0: no place is found, as of the sky
  std::uint32_t held = 0;  // by which of the nodes that were asked, a bit each
};
// The places on kViewColumns x kViewRows lines of sight of the frame, row by row from below. At
// most 32 nodes are asked. Of what one of the first `drawn` of them holds it is not found out who
// else does.
inline constexpr int kViewColumns = FrameParts::kColumns, kViewRows = FrameParts::kRows;
[[nodiscard]] std::vector<SeenPlace> places_in_view(const EnvironmentNodes& nodes,
                                                    const Camera& frame,
                                                    std::span<const std::size_t> asked,
                                                    std::size_t drawn);

}  // namespace rilievo

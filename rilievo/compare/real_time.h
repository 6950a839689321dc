// A method measured while the eye moves by the clock.
//
// A frame shows where the eye is when its drawing starts; a slow method moves further from frame to
// frame. The walk starts when the first frame is complete. Only drawing counts, not the reading of
// frames that are kept to be compared. Results depend on the machine's speed.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/compare/drawn_frame.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"

namespace rilievo {

// The walk and its frames.
struct RealTimeOptions {
  double seconds = 4;  // of the walk
  int kept = 8;        // frames to compare, spread evenly over the walk
  int in_a_row = 1;    // so many frames that follow each other are kept at each of these places
  BoundLimits limits;
  double refresh = 60;  // the most frames that a display shows in a second
  // Frames wait for the display, so that what works beside them has its time. Otherwise the clock
  // goes on at once where a frame takes less.
  bool waits = false;
  bool each_frame = false;   // the eye moves from frame to frame as at that rate, not by the clock
  std::vector<double> cuts;  // times at which the eye jumps, ascending
};

// A method's walk.
struct RealTimeWalk {
  double first_frame_ms = 0;
  std::vector<double> frame_ms;  // of all frames after the first
  // The longest time of the first frame after a cut, which is complete, but may be coarse; and
  // until a frame was complete whose bounds are within their limits.
  std::optional<double> cut_ms, cut_fine_ms;
  double over_bound_share = 0;  // of frames with a bound above its limit
  int captures = 0;
  double capture_ms = 0, bound_px = 0, gap_px = 0;
  std::size_t picture_bytes = 0;
  std::vector<std::pair<WalkFrame, DrawnFrame>> kept;  // kept x in_a_row
  std::vector<double> busy_ms;  // processor time, of all threads, of the frames not kept
};

// The times at which the eye jumps (is_cut), seconds after the first key.
[[nodiscard]] std::vector<double> cuts_of(const CameraPath& path);

// Walks with `source`; `walk` gives the camera `seconds` after the start. Draws on after the end of
// the walk until all frames to be kept are drawn. Needs a current OpenGL context unless the source
// draws without.
[[nodiscard]] Result<RealTimeWalk> walk_in_real_time(
    FrameSource& source, const DrawTargets& targets,
    const std::function<WalkFrame(double seconds)>& walk, const RealTimeOptions& options);

}  // namespace rilievo

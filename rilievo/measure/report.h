// A report: how fast and how right each method is along a walk through a scene.
//
// The results of `rilievo compare`, as "rilievo-report-1" JSON for programs and as one HTML page
// without external files.
//
// The PSNR of identical frames is infinite, which JSON cannot express and a mean cannot use. Values
// above kMaxPsnrDb count as kMaxPsnrDb. The mean and the least PSNR are those of frames that show
// pictures, if any frame does: frames of polygons alone are the true frames, and say nothing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/measure/html.h"
#include "rilievo/measure/machine.h"
#include "rilievo/measure/stats.h"

namespace rilievo {

// The largest PSNR in a report. One channel off by one step in one pixel of a 1280 x 720 frame is
// already 112 dB.
inline constexpr double kMaxPsnrDb = 100;

// The measures of one frame against the true frame.
struct FrameResult {
  double frame_ms = 0;
  double psnr_db = 0, ssim = 1, flip = 0;
  double wrong_visibility = 0, uncovered = 0;  // shares, 0 to 1
  double counted = 1;                          // the share of pixels that wrong_visibility counts
  double gap_px = 0;                           // as widest_gap_px()
  double flip_p99 = 0;                         // of FLIP's map
  double ghost = 0, speckle = 0;               // as count_artifacts()
  bool pictures = true;                        // shows some; not polygons alone
};

// How far from their true places surfaces were drawn, in pixels (compare/drawn_error.h), and what
// was measured: shares of the pixels that show an object in the true frames.
struct ErrorPx {
  double p50 = 0, p99 = 0, max = 0;
  double resolution = 0;  // what rounding may make of an error of 0, pixels
  double measured = 0;    // and not measured:
  double boundary = 0;    // beside an object's boundary, or another object
  double mixed = 0;       // beside a step of the depth
  double unresolved = 0;  // too near or too far away
  // The share of those measured that lie above the bound of their frame by more than the
  // resolution; and the number of pixels above it by half a pixel's diagonal besides, which bounds
  // leave to texels.
  double over_bound = 0;
  std::int64_t violations = 0;
  // Pixels above it as far that are no violations: they show what lies behind, in a gap that is no
  // wider than the frame's bound of gaps.
  std::int64_t in_gaps = 0;
};

// The measures of one method along the walk.
struct MethodResult {
  std::string name;
  std::vector<FrameResult> frames;  // as many as every other method has, at least one
  // As flicker(), of each frame but the first. Empty if frames do not follow each other.
  std::vector<double> flicker;
  double depth_error_p50 = 0, depth_error_p99 = 0;
  std::int64_t captures = 0;
  double capture_ms = 0;            // sum over all frames
  std::uint64_t picture_bytes = 0;  // the maximum over the walk
  // Set where the method provides them:
  std::optional<double> bound_px_max;
  std::optional<double> gap_bound_px_max;  // of the strips that were hidden at capture
  std::optional<ErrorPx> error_px;
  // The first frame, which fills caches; it is not among `frames`.
  std::optional<double> first_frame_ms;
  // The longest time of the first frame after a cut, which may be coarse; where there are cuts.
  std::optional<double> cut_ms;
  std::optional<double> over_bound_share;  // of frames with a bound above what is allowed
  // In real time: all frames after the first. `frames` are those that were compared.
  std::optional<Summary> walked_ms;
  std::optional<int> walked_frames;
  // The largest excess change from frame to frame (FLIP) over the true frames' change (popping.h).
  std::optional<double> pop_max;                               // over tiles
  std::optional<double> pop_frame_max;                         // over whole frames
  std::vector<std::pair<std::string, std::int64_t>> drawn_as;  // "polygons", "nailboard", ...
  // For each frame of a method that chooses between others: "NAME (why)".
  std::vector<std::string> decisions;
  // For the page, one for each frame shown, in order:
  std::vector<EncodedPicture> pictures, differences;
};

// The results of all methods, and what they were measured on.
struct Report {
  std::string commit = "unknown";
  Machine machine;
  std::string scene_name;
  std::uint64_t triangles = 0, objects = 0;
  int width = 0, height = 0;
  std::string antialiasing;        // in words; the same for all frames, the true ones included
  std::string command;             // reproduces the report
  std::vector<std::string> notes;  // additional sentences for the page
  std::vector<MethodResult> methods;
  // For the page: the numbers of the frames shown, and the true frames:
  std::vector<int> shown;
  std::vector<EncodedPicture> true_pictures;
};

// The report as JSON. Requires at least one method, and equally many frames of each.
[[nodiscard]] std::string report_json(const Report& report);
// The report as a page. Requires the same, and one picture of everything for each frame shown.
[[nodiscard]] std::string report_html(const Report& report);

// At most `most` frame numbers out of `frames` frames, evenly spaced, with the first and the
// last.
[[nodiscard]] std::vector<int> frames_to_show(int frames, int most);

// A picture of the differences between two frames of one size: black where they are equal, over
// violet and orange to white where a channel differs by `full_scale` or more.
[[nodiscard]] Rgba8Image difference_picture(const Rgba8Image& a, const Rgba8Image& b,
                                            int full_scale = 64);

}  // namespace rilievo

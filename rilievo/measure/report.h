// How fast and how right is each way of drawing a walk through a scene?
//
// The figures of `rilievo compare`, as "rilievo-report-1" JSON for programs and as one page for
// people, which holds everything in itself and works without a network.
//
// PSNR of identical frames is infinite, which JSON cannot say and a mean cannot use: figures above
// kMostPsnrDb count as kMostPsnrDb.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/measure/html.h"
#include "rilievo/measure/machine.h"

namespace rilievo {

// One pixel of a 1280 x 720 frame off by one step in one channel is 112 dB.
inline constexpr double kMostPsnrDb = 100;

struct FrameResult {
  double frame_ms = 0;
  double psnr_db = 0, ssim = 1, flip = 0;
  double wrong_visibility = 0, uncovered = 0;  // shares, 0 to 1
};

struct ErrorPx {
  double p50 = 0, p99 = 0, max = 0;
};

struct MethodResult {
  std::string name;
  std::vector<FrameResult> frames;  // as many as the report has, at least one
  double depth_error_p50 = 0, depth_error_p99 = 0;
  std::int64_t captures = 0;
  double capture_ms = 0;            // over all frames
  std::uint64_t picture_bytes = 0;  // the most held at a time
  // Where they are known:
  std::optional<double> bound_px_max;
  std::optional<double> gap_bound_px_max;  // of strips that lack what was hidden at capture
  std::optional<ErrorPx> error_px;
  // The most by which a frame differs from the one before it (FLIP) above the true frames' change.
  std::optional<double> pop_max;                               // over tiles (popping.h)
  std::optional<double> pop_frame_max;                         // over whole frames
  std::vector<std::pair<std::string, std::int64_t>> drawn_as;  // "polygons", "nailboard", ...
  // For the page: one of each for every frame shown, in their order.
  std::vector<EncodedPicture> pictures, differences;
};

struct Report {
  std::string commit = "unknown";
  Machine machine;
  std::string scene_name;
  std::uint64_t triangles = 0, objects = 0;
  int width = 0, height = 0;
  std::string antialiasing;        // in words: what all frames, the true ones too, have in common
  std::string command;             // how to run it again
  std::vector<std::string> notes;  // further sentences for the page
  std::vector<MethodResult> methods;
  // For the page: the frames shown (of 0 ... n - 1), and what they should look like.
  std::vector<int> shown;
  std::vector<EncodedPicture> true_pictures;
};

// Requires at least one method, and equally many frames of each.
[[nodiscard]] std::string report_json(const Report& report);
// Likewise, and as many pictures of everything as frames are shown.
[[nodiscard]] std::string report_html(const Report& report);

// At most `most` of `frames` frames, evenly spread, the first and the last among them.
[[nodiscard]] std::vector<int> frames_to_show(int frames, int most);

// Where and how much two frames of one size differ: black where they are the same, over violet and
// orange to white where a channel is off by `full_scale` or more.
[[nodiscard]] Rgba8Image difference_picture(const Rgba8Image& a, const Rgba8Image& b,
                                            int full_scale = 64);

}  // namespace rilievo

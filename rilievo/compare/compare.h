// Compares how fast, and how right, several methods are along the same walk.
//
// The first source draws the true frames (direct drawing). All sources are timed alike, with the
// same antialiasing: wall-clock time from FrameTarget::begin() until the GPU has finished after
// resolve(). Colours are compared as displayed, with the first source's or with `reference`;
// objects and depths are compared in a second drawing with one sample per pixel. Each source draws
// a block of frames, then all are measured, so that measuring does not disturb the timing.
//
// Needs a current OpenGL context unless all sources draw without; measuring uses all cores. Apart
// from times, the results do not depend on the machine's speed or its number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "rilievo/compare/drawn_frame.h"
#include "rilievo/compare/real_time.h"
#include "rilievo/compare/reference_frames.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/measure/report.h"

namespace rilievo {

// A method by name: a source that draws, or frames that another program has drawn.
struct ComparedSource {
  std::string name;
  FrameSource* source = nullptr;
  // Instead of the source, if there is none: reads a frame of the walk. Without identifiers and
  // depths, what needs them is not measured.
  std::function<Result<DrawnFrame>(int frame)> read = {};
};

// The frames and what to measure.
struct CompareOptions {
  int width = 1280, height = 720;
  int samples = 4;
  int frames = 120;
  // How often frame 0 is drawn before timing starts. Captures made then count as captures.
  int warm_up = 1;
  // Memory for frames that wait to be measured.
  std::size_t max_bytes = std::size_t(256) << 20;
  // Measures how much more the method's frames change than the true ones (popping.h).
  bool pop = false;
  // The largest number of frames with pictures in the report.
  int shown_frames = 8;
  BoundLimits limits;  // for MethodResult::over_bound_share
  // True colours with more samples (compare/reference_frames.h); null: the first source's.
  ReferenceFrames* reference = nullptr;
  std::function<void(int done, int total)> progress;
};

// The smallest width and height that can be measured, pixels.
inline constexpr int kMinCompareSize = 16;

// Draws and measures all frames. Fills the parts of the report that drawing determines: machine,
// size, antialiasing, methods, pictures. Requires at least one source and one frame; the first
// source draws.
[[nodiscard]] Result<Report> compare(std::span<const ComparedSource> sources,
                                     const std::function<WalkFrame(int frame)>& walk,
                                     const CompareOptions& options);

// The same with the eye moving by the clock: `walk` gives the camera `seconds` after the start.
// Times are of all frames, measures of `real_time.kept` frames spread evenly over each method's own
// walk, against true frames from the same eyes. The report shows no pictures. Uses the size and
// samples of `options`. All sources draw.
[[nodiscard]] Result<Report> compare_in_real_time(
    std::span<const ComparedSource> sources, const std::function<WalkFrame(double seconds)>& walk,
    const CompareOptions& options, const RealTimeOptions& real_time);

}  // namespace rilievo

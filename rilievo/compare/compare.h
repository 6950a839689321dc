// How fast, and how right, are several ways to draw the same walk?
//
// The first source draws the true frames (direct drawing); every source is timed alike: wall clock
// from FrameTarget::begin() until the GPU has finished after resolve(), with the same antialiasing.
// Colours are compared as they are shown, objects and depths in a second drawing with one sample a
// pixel. Frames are drawn source by source in blocks and measured between the blocks, so that
// measuring does not disturb the timing.
//
// Needs a current OpenGL context; measuring uses all cores. Figures other than times do not depend
// on the machine's speed or its number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "rilievo/compare/drawn_frame.h"
#include "rilievo/core/result.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/measure/report.h"

namespace rilievo {

struct ComparedSource {
  std::string name;
  FrameSource* source = nullptr;
};

struct CompareOptions {
  int width = 1280, height = 720;
  int samples = 4;
  int frames = 120;
  // Frame 0 is drawn this many times before the clock runs. What is captured then counts as
  // captured.
  int warm_up = 1;
  // For frames that wait to be measured.
  std::size_t max_bytes = std::size_t(256) << 20;
  // The error of every so many texels in x and y of every picture drawn is measured; 0: none.
  int error_step = 4;
  // Measure how much more than the true ones frames differ from those before them (popping.h).
  bool pop = false;
  // At most so many frames' pictures go into the report.
  int shown_frames = 8;
  std::function<void(int done, int total)> progress;
};

// What measuring takes: the smallest frame.
inline constexpr int kLeastCompareSize = 16;

// Fills in all of the report that has to do with drawing: machine, size, antialiasing, methods,
// pictures. Requires at least one source and one frame.
[[nodiscard]] Result<Report> compare(std::span<const ComparedSource> sources,
                                     const std::function<WalkFrame(int frame)>& walk,
                                     const CompareOptions& options);

}  // namespace rilievo

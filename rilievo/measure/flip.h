// FLIP: the difference that an observer sees who flips between two frames.
//
// LDR-FLIP of [Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild 2020], "FLIP: A
// difference evaluator for alternating images": colour differences filtered by the eye's contrast
// sensitivity, amplified where edges or points appear or vanish. Frames are 8-bit sRGB; alpha is
// ignored. Values lie between 0 (no difference) and 1.
//
// Where frames are equal within the filters' reach it costs next to nothing.
//
// Strips of rows run in parallel; the result depends neither on the number of threads nor on the
// instruction set.
#pragma once

#include <memory>

#include "rilievo/core/color.h"

namespace rilievo {

// The viewing conditions.
struct FlipOptions {
  // Pixels per degree of the observer's view: 67 is a 4K screen 0.7 m wide seen from 0.7 m.
  // Requires 5 to 500.
  double pixels_per_degree = 67;
};

// The difference at each pixel. Requires two frames of one size, of at least one pixel.
[[nodiscard]] Image<float> flip_map(const Rgba8Image& truth, const Rgba8Image& frame,
                                    const FlipOptions& options = {});

// The mean of the map: the single number that the authors recommend.
[[nodiscard]] double flip(const Rgba8Image& truth, const Rgba8Image& frame,
                          const FlipOptions& options = {});

// The map's mean, and the smallest value that 99 % of its pixels do not exceed: faults that cover a
// small part of the frame show in the latter only.
struct FlipSummary {
  double mean = 0, p99 = 0;
};
[[nodiscard]] FlipSummary summarize_flip(const Rgba8Image& truth, const Rgba8Image& frame,
                                         const FlipOptions& options = {});

// A frame that several others are compared with: its filters run once.
class FlipTruth {
 public:
  // `truth` must outlive the object.
  explicit FlipTruth(const Rgba8Image& truth, const FlipOptions& options = {});
  ~FlipTruth();
  FlipTruth(FlipTruth&&) = delete;

  // The same number as flip(truth, frame, options). Any thread may call it.
  [[nodiscard]] double flip(const Rgba8Image& frame) const;

 private:
  struct State;
  friend Image<float> flip_map(const Rgba8Image& truth, const Rgba8Image& frame,
                               const FlipOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo

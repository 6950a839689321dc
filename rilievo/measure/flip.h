// How different do two frames look to somebody who flips between them?
//
// LDR-FLIP of [Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild 2020], "FLIP: A
// difference evaluator for alternating images": differences of colour as seen through the eye's
// contrast sensitivity, amplified where edges or points appear or vanish. Frames are 8-bit sRGB;
// alpha is ignored. From 0 (no difference) to 1.
//
// Strips of rows run in parallel; the figures do not depend on the number of threads.
#pragma once

#include "rilievo/core/color.h"

namespace rilievo {

struct FlipOptions {
  // Of the observer: 67 is a 4K screen 0.7 m wide seen from 0.7 m. Requires 5 to 500.
  double pixels_per_degree = 67;
};

// Requires two frames of one size, of at least one pixel.
[[nodiscard]] Image<float> flip_map(const Rgba8Image& truth, const Rgba8Image& frame,
                                    const FlipOptions& options = {});

// The mean of the map, which its authors recommend as the single figure.
[[nodiscard]] double flip(const Rgba8Image& truth, const Rgba8Image& frame,
                          const FlipOptions& options = {});

}  // namespace rilievo

// What rays found in a pixel of a warped frame that no keyframe shows.
#pragma once

#include <cstdint>

namespace rilievo {

// A pixel, filled. The words of a vector of OpenGL's.
struct FilledHole {
  std::uint32_t x, y;   // y from the top
  std::uint32_t color;  // as WarpedFrame's
  float inverse_z;      // 1 / eye_z of the first of its samples that shows something; 0: the sky
};

}  // namespace rilievo

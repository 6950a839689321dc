// The error of the depth that a nailboard writes by eq. (4) of [Schaufler 1997] (S1.3, figure 8).
//
// In doubles and without OpenGL: the formula's own error, apart from the bits of Delta and of the
// z-buffer. As a distance from the eye, in percent.
#pragma once

#include <glm/glm.hpp>

namespace rilievo::bench {

// What happened to the eye since the capture. Fractions of the object's distance.
struct EyeMotion {
  double along = 0;   // towards the object
  double across = 0;  // to the right
  double turn_degrees = 0;
};

// The error of the texel at raster position `raster` of a picture of 1 x 1 texels with a field of
// view of 60 degrees, n = 10, f = 1000: the object reaches from d to 2 d, and the nearer end is at
// `d` from the moved eye's plane. `delta` in [0, 1]. Requires along < 1.
[[nodiscard]] double depth_error_percent(const EyeMotion& motion, double d,
                                         const glm::dvec2& raster, double delta);

// The largest over the picture and over Delta.
[[nodiscard]] double max_depth_error_percent(const EyeMotion& motion, double d);

}  // namespace rilievo::bench

// How wrong is the depth that a nailboard writes by eq. (4) of [Schaufler 1997] (S1.3)?
//
// In doubles and without OpenGL: the formula's own error, apart from the bits of Delta and of the
// z-buffer.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo::bench {

struct LinearDepth {
  double exact_eye_z = 0;   // of the texel's own point, by section 3 (S1.2)
  double ray_eye_z = 0;     // exact too, of the point where eq. (4) looks: on the pixel's line of
                            // sight, as far between the frustum's planes as the texel's point
  double linear_eye_z = 0;  // what eq. (4) gives, as a distance from the eye plane
};

// The texel at `raster` of the picture taken by `capture`, with texture depth `delta` (window_z of
// `capture`, in [0, 1]), as `frame` draws it. The polygon lies in the near plane of `capture`.
[[nodiscard]] LinearDepth linear_depth(const Camera& capture, const glm::dvec2& raster,
                                       double delta, const Camera& frame);

}  // namespace rilievo::bench

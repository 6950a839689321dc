// From where, and how finely, is a picture of some bounds to be captured for a frame?
//
// Pure; no OpenGL.
#pragma once

#include <optional>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"

namespace rilievo {

struct PictureCameraOptions {
  double texels_per_pixel = 1.0;
  int max_size = 1024;      // texels a side
  double min_front = 0.25;  // nearest distance of the bounds to the eye, in diameters of the bounds
};

// The tight perspective camera at the frame's eye around `bounds`, with at least `texels_per_pixel`
// texels to each pixel of the frame in both directions wherever the bounds lie in it, and an empty
// border of one texel, so that neighbours in an atlas do not bleed in. Nothing if the eye is too
// near to the bounds, or the picture would be larger than `max_size`.
[[nodiscard]] std::optional<Camera> picture_camera(const Camera& frame, const Box& bounds,
                                                   const PictureCameraOptions& options = {});

}  // namespace rilievo

// From where, and at which resolution, is a picture captured for a frame?
//
// Pure; no OpenGL.
#pragma once

#include <optional>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"

namespace rilievo {

// Resolution and limits.
struct PictureCameraOptions {
  double texels_per_pixel = 1.0;
  int max_size = 1024;      // texels a side
  double min_front = 0.25;  // least distance from the eye to the bounds, in diameters of the bounds
};

// The tight perspective camera at the frame's eye around `bounds`. It has at least
// `texels_per_pixel` texels for each pixel of the frame, in both directions, wherever the bounds
// cover the frame, and an empty border of one texel, so that neighbours in an atlas do not bleed
// in. None if the eye is too near to the bounds, or if the picture would exceed `max_size`.
[[nodiscard]] std::optional<Camera> picture_camera(const Camera& frame, const Box& bounds,
                                                   const PictureCameraOptions& options = {});

// Widens an interval of a window, [from, to], to whole texels of width `step` that begin at
// from = `origin` plus a whole number of them, and counts them: at least one.
void align_to_texels(double origin, double step, double& from, double& to, int& texels);

}  // namespace rilievo

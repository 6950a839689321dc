// How far may the eye go before a picture must be captured again?
//
// The inverse of bound_error(): a ball around the capture eye, in the space in which the object
// stood at the capture, in which every frame camera of a given size and field of view, however
// turned, draws the picture within the allowed error. Asking whether an eye is in the ball is all
// that a valid picture costs per frame. Pure, no allocation, any thread.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/nailboard/error.h"

namespace rilievo {

struct SafeRegion {
  glm::dvec3 eye{0.0};  // the capture eye
  double radius = 0;    // metres; < 0: not even there
};

// Upper bound of bound_error(...).total_px over all eyes at most `eye_offset` from the capture eye
// and all frames of `frame`'s size and field of view that see the picture within `off_axis_tan` of
// their axis (corner_tan(frame): anywhere). Grows with the offset; infinite from the
// capture's near plane on.
[[nodiscard]] double ball_error_px(const PictureGeometry& picture, const Camera& frame,
                                   double off_axis_tan, double eye_offset);

// The largest ball in which ball_error_px is at most `error_px` (to a relative 1e-9 of its radius).
[[nodiscard]] SafeRegion safe_region(const PictureGeometry& picture, const Camera& frame,
                                     double off_axis_tan, double error_px);

[[nodiscard]] inline bool contains(const SafeRegion& region, const glm::dvec3& eye) {
  const glm::dvec3 offset = eye - region.eye;
  return region.radius >= 0 && glm::dot(offset, offset) <= region.radius * region.radius;
}

// For how long does an eye at `eye` with a steady `velocity` (metres per unit of time) stay in the
// region? In that unit; 0 if it is outside, infinite if it never leaves. Both are relative to the
// object: a moving object's own motion is to be taken off.
[[nodiscard]] double expected_lifetime(const SafeRegion& region, const glm::dvec3& eye,
                                       const glm::dvec3& velocity);

}  // namespace rilievo

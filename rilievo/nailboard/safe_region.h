// How far can the eye move before a picture must be captured again?
//
// The inverse of bound_error(): a ball around the capture eye, in the space of the object at
// capture. Inside, every frame camera of a given size and field of view, in any orientation, draws
// the picture within the allowed error. A valid picture then costs one test per frame. Pure, no
// allocation, any thread.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/nailboard/error.h"

namespace rilievo {

// A ball of eye positions.
struct SafeRegion {
  glm::dvec3 eye{0.0};  // the capture eye
  double radius = 0;    // metres; negative: the picture is not good even at the capture eye
};

// An upper bound of bound_error(...).total_px over all eyes at most `eye_offset` metres from the
// capture eye and all frames of `frame`'s size and field of view that see the picture within
// `off_axis_tan` of their axis (corner_tan(frame): anywhere). Grows with the offset; infinite
// beyond the capture's near plane.
[[nodiscard]] double ball_error_px(const PictureGeometry& picture, const Camera& frame,
                                   double off_axis_tan, double eye_offset);

// The largest ball in which ball_error_px is at most `error_px` (its radius has a relative error of
// at most 1e-9).
[[nodiscard]] SafeRegion safe_region(const PictureGeometry& picture, const Camera& frame,
                                     double off_axis_tan, double error_px);

// Does the eye (object space at capture) lie in the region?
[[nodiscard]] inline bool contains(const SafeRegion& region, const glm::dvec3& eye) {
  const glm::dvec3 offset = eye - region.eye;
  return region.radius >= 0 && glm::dot(offset, offset) <= region.radius * region.radius;
}

// How long an eye at `eye` with a constant `velocity` (metres per unit of time) stays in the
// region, in that unit: 0 if it is outside, infinite if it never leaves. Both are relative to the
// object, so subtract the motion of a moving object.
[[nodiscard]] double expected_lifetime(const SafeRegion& region, const glm::dvec3& eye,
                                       const glm::dvec3& velocity);

}  // namespace rilievo

// Bounds of the parallax of a flattened sample: how far the eye can move before it visibly slides.
//
// A sample at eye distance `back` is drawn at eye distance `front` on the same capture ray, or the
// reverse. Both project to one pixel from the capture eye. From any other eye they are seen under
// the parallax angle, which these functions bound.
//
// Distances: metres from the capture eye, along its -z (eye_z). Eye offsets: metres, in the capture
// eye's space. Angles: radians. Pure, no allocation, any thread.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/core/picture_geometry.h"

namespace rilievo {

// The largest parallax angle between two points of one capture ray within the slab, over all eyes
// at most `eye_offset` from the capture eye. Exact over that ball. Requires 0 <= eye_offset <
// slab.front.
[[nodiscard]] double max_parallax(DepthSlab slab, double eye_offset) noexcept;

// The inverse of max_parallax: the radius of the largest ball of eyes in which the angle stays at
// most `angle`, but not more than slab.front. Requires 0 <= angle < pi / 2.
[[nodiscard]] double parallax_radius(DepthSlab slab, double angle) noexcept;

// The same between a sample anywhere in the slab and its place on the flat picture at `plane_z`.
// Also requires slab.front <= plane_z <= slab.back.
[[nodiscard]] double max_flat_parallax(DepthSlab slab, double plane_z, double eye_offset) noexcept;
[[nodiscard]] double flat_parallax_radius(DepthSlab slab, double plane_z, double angle) noexcept;

// The same for one eye at `eye` (capture eye space) and the rays through `window`. Never more than
// over the ball of radius |eye|, and much less for a motion along the line of sight. Requires
// |eye| < slab.front.
[[nodiscard]] double max_flat_parallax(DepthSlab slab, double plane_z, const ImageWindow& window,
                                       const glm::dvec3& eye) noexcept;

// The largest distance in pixels between two points of the frame whose lines of sight differ by
// `angle`, one of them within `off_axis_tan` (tangent of the angle from the frame's axis). Infinite
// if the other can reach the plane of the eye. Requires a perspective camera and
// 0 <= angle < pi / 2.
[[nodiscard]] double pixels_from_angle(const Camera& frame, double off_axis_tan,
                                       double angle) noexcept;
// The inverse of pixels_from_angle: the largest angle that never covers more than `pixels`.
[[nodiscard]] double angle_from_pixels(const Camera& frame, double off_axis_tan,
                                       double pixels) noexcept;

// The tangent of the angle between the frame's axis and the farthest corner of its image.
[[nodiscard]] double corner_tan(const Camera& frame) noexcept;

}  // namespace rilievo

// Closed forms for both parts of the error, each growing with the offset, and a bisection of their
// sum.
#include "rilievo/nailboard/safe_region.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/nailboard/picture_rays.h"

namespace rilievo {
namespace {}  // namespace

double ball_error_px(const PictureGeometry& picture, const Camera& frame, double off_axis_tan,
                     double eye_offset) {
  // The frame asks for whatever lies in the capture's frustum, not only for what the slab holds.
  const Camera& capture = picture.capture;
  const DepthSlab whole{std::min(capture.z_near, picture.slab.front),
                        std::max(capture.z_far, picture.slab.back)};
  if (eye_offset >= whole.front) return kInfinity;
  const ImageWindow& w = capture.window;
  const double half =
      0.5 * std::hypot((w.right - w.left) / capture.width, (w.top - w.bottom) / capture.height);
  // At the distance z a half texel is z * half long and at least z - eye_offset away: of all
  // triangles with that base and that shortest side, the right-angled one has the widest angle at
  // the eye.
  const auto sine_of_half_texel = [&](double z) { return z * half / (z - eye_offset); };
  if (sine_of_half_texel(whole.front) >= 1) return kInfinity;
  const double half_texel = std::asin(sine_of_half_texel(picture.plane_z));
  const double magnification =
      std::max(0.0, pixels_from_angle(frame, off_axis_tan, half_texel) - std::sqrt(0.5));
  // How far off the axis is a texel's centre drawn, if the frame shows a part of its cell or asks
  // for any other depth on its ray? The outline of a frame that grows by an angle on all sides
  // grows at its corners, which are obtuse, by less than its square root of 2.
  const double centre_angle =
      std::atan(off_axis_tan) + std::asin(sine_of_half_texel(whole.front)) +
      std::sqrt(2.0) * max_flat_parallax(whole, picture.plane_z, eye_offset);
  const double parallax = max_flat_parallax(picture.slab, picture.plane_z, eye_offset);
  if (centre_angle + parallax >= std::acos(0.0)) return kInfinity;
  // The near plane must not cut the rectangle.
  if ((picture.plane_z - eye_offset) * std::cos(centre_angle) < frame.z_near) return kInfinity;
  return magnification + pixels_from_angle(frame, std::tan(centre_angle), parallax);
}

SafeRegion safe_region(const PictureGeometry& picture, const Camera& frame, double off_axis_tan,
                       double error_px) {
  SafeRegion region{picture.capture.position(), -1};
  if (ball_error_px(picture, frame, off_axis_tan, 0) > error_px) return region;
  // The parallax alone, in closed form, is where the search starts: magnification only shrinks it.
  double inside = 0;
  double outside = flat_parallax_radius(picture.slab, picture.plane_z,
                                        angle_from_pixels(frame, off_axis_tan, error_px));
  outside = std::max(outside, 1e-9 * picture.slab.front) * (1 + 1e-9);
  while (outside - inside > std::max(1e-9 * outside, 1e-12 * picture.slab.front)) {
    const double middle = 0.5 * (inside + outside);
    (ball_error_px(picture, frame, off_axis_tan, middle) <= error_px ? inside : outside) = middle;
  }
  region.radius = inside;
  return region;
}

// |offset + velocity s| = radius, the later solution.
double expected_lifetime(const SafeRegion& region, const glm::dvec3& eye,
                         const glm::dvec3& velocity) {
  if (!contains(region, eye)) return 0;
  const glm::dvec3 offset = eye - region.eye;
  const double vv = glm::dot(velocity, velocity), ov = glm::dot(offset, velocity);
  if (vv == 0) return kInfinity;
  const double slack = region.radius * region.radius - glm::dot(offset, offset);
  // Of the two forms of the root, the one without cancellation.
  const double root = std::sqrt(ov * ov + vv * slack);
  return ov <= 0 ? (root - ov) / vv : slack / (root + ov);
}

}  // namespace rilievo

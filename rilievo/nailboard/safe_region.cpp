// Closed forms for both parts of the error, each growing with the offset, and a bisection of their
// sum.
#include "rilievo/nailboard/safe_region.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double ball_error_px(const PictureGeometry& picture, const Camera& frame, double off_axis_tan,
                     double eye_offset) {
  if (eye_offset >= picture.slab.front) return kInfinity;
  const ImageWindow& w = picture.capture.window;
  // A half texel is plane_z * half long and at least plane_z - eye_offset away: of all triangles
  // with that base and that shortest side, the right-angled one has the widest angle at the eye.
  const double half = 0.5 * std::hypot((w.right - w.left) / picture.capture.width,
                                       (w.top - w.bottom) / picture.capture.height);
  const double sine = picture.plane_z * half / (picture.plane_z - eye_offset);
  if (sine >= 1) return kInfinity;
  const double half_texel = std::asin(sine);
  const double magnification =
      std::max(0.0, pixels_from_angle(frame, off_axis_tan, half_texel) - std::sqrt(0.5));
  // A texel's centre may lie outside the frame that shows a part of its cell.
  const double centre_angle = std::atan(off_axis_tan) + half_texel;
  const double parallax = max_flat_parallax(picture.slab, picture.plane_z, eye_offset);
  if (centre_angle + parallax >= std::acos(0.0)) return kInfinity;
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

// Cf. [Schaufler 1995] on the error angles of a moving eye. Derived here: one closed form for
// a whole ball of eyes, its inverse, and a bound for one known eye.
//
//        T           C capture eye      F, B samples at `front` and `back`
//      /  \ `-.      r eye offset, CT   T worst eye: where the circle through F and B
//    C-----F----B                       touches the ball (C, r)
//
// That circle has radius R = (f b - r^2) / 2r, the chord FB is b - f long, and an inscribed
// angle obeys sin(FTB) = chord / 2R. Hence
//
//   sin(parallax) = r (b - f) / (f b - r^2)                                             (1)
//
// Solved for r, with s = sin(parallax):  s r^2 + (b - f) r - s f b = 0, or
//
//   r = 2 s f b / ((b - f) + sqrt((b - f)^2 + 4 s^2 f b))                               (2)
//
// The slab is measured along -z. On a ray that leaves the axis by the factor k = |(x, y, -1)| >= 1
// the distances are k f and k b, and (1) becomes smaller: the axis is the worst ray.
#include "rilievo/warp/parallax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Distance from `eye` to the rectangle of `window` on the plane eye_z = z.
double distance_to_rectangle(const ImageWindow& w, double z, const glm::dvec3& eye) {
  const double x = std::clamp(eye.x, w.left * z, w.right * z);
  const double y = std::clamp(eye.y, w.bottom * z, w.top * z);
  return glm::length(glm::dvec3(x, y, -z) - eye);
}

double scale_px(const Camera& frame) {
  return std::max(frame.width / (frame.window.right - frame.window.left),
                  frame.height / (frame.window.top - frame.window.bottom));
}

}  // namespace

double max_parallax(DepthSlab slab, double eye_offset) noexcept {
  RILIEVO_EXPECTS_LT(0.0, slab.front);
  RILIEVO_EXPECTS_LE(slab.front, slab.back);
  RILIEVO_EXPECTS_LE(0.0, eye_offset);
  RILIEVO_EXPECTS_LT(eye_offset, slab.front);
  const double sine =
      eye_offset * (slab.back - slab.front) / (slab.front * slab.back - eye_offset * eye_offset);
  return std::asin(std::min(sine, 1.0));
}

double parallax_radius(DepthSlab slab, double angle) noexcept {
  RILIEVO_EXPECTS_LE(0.0, angle);
  const double s = std::sin(angle), depth = slab.back - slab.front, fb = slab.front * slab.back;
  if (depth <= 0) return slab.front;
  const double radius = 2 * s * fb / (depth + std::sqrt(depth * depth + 4 * s * s * fb));
  return std::min(radius, slab.front);
}

double max_flat_parallax(DepthSlab slab, double plane_z, double eye_offset) noexcept {
  return std::max(max_parallax({slab.front, plane_z}, eye_offset),
                  max_parallax({plane_z, slab.back}, eye_offset));
}

double flat_parallax_radius(DepthSlab slab, double plane_z, double angle) noexcept {
  // Beyond plane_z is beyond the slab's front: the first of the two never exceeds that.
  return std::min(parallax_radius({slab.front, plane_z}, angle),
                  parallax_radius({plane_z, slab.back}, angle));
}

// The eye e sees p r and d r, two points of the capture ray r = (x, y, -1), under
//
//   sin(parallax) = |(p r - e) x (d r - e)| / (|p r - e| |d r - e|)
//                 = |d - p| |r x e| / (|p r - e| |d r - e|)
//
// For a fixed ray the angle grows as d leaves p, so that the slab's ends are the worst samples.
// |r x e| is convex in (x, y), so that a corner of the window is its largest value; the distances
// are at least those to the rectangles that the window cuts out of the planes p and d. No angle
// passes pi / 2 within |e| < front by (1), so that the sine bounds the angle.
double max_flat_parallax(DepthSlab slab, double plane_z, const ImageWindow& window,
                         const glm::dvec3& eye) noexcept {
  const double over_ball = max_flat_parallax(slab, plane_z, glm::length(eye));
  const std::array<glm::dvec3, 4> rays{
      glm::dvec3(window.left, window.bottom, -1), glm::dvec3(window.right, window.bottom, -1),
      glm::dvec3(window.left, window.top, -1), glm::dvec3(window.right, window.top, -1)};
  double moment = 0;
  for (const glm::dvec3& ray : rays) moment = std::max(moment, glm::length(glm::cross(ray, eye)));
  const double to_plane = distance_to_rectangle(window, plane_z, eye);
  double sine = 0;
  for (double d : {slab.front, slab.back}) {
    const double to_sample = distance_to_rectangle(window, d, eye);
    sine = std::max(sine, std::abs(d - plane_z) * moment / (to_plane * to_sample));
  }
  return std::min(over_ball, std::asin(std::min(sine, 1.0)));
}

double corner_tan(const Camera& frame) noexcept {
  const ImageWindow& w = frame.window;
  return std::hypot(std::max(std::abs(w.left), std::abs(w.right)),
                    std::max(std::abs(w.bottom), std::abs(w.top)));
}

// The directions within `angle` of one that is a off the axis meet the image plane in an ellipse
// whose long axis is radial and reaches from tan(a - angle) to tan(a + angle). The direction itself
// meets it nearer to the inner end, so that the outer end is the farthest point:
//
//   tan(a + angle) - tan(a) = tan(angle) (1 + tan(a)^2) / (1 - tan(a) tan(angle))
double pixels_from_angle(const Camera& frame, double off_axis_tan, double angle) noexcept {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  const double t = std::tan(angle), left = 1 - off_axis_tan * t;
  if (left <= 0) return std::numeric_limits<double>::infinity();
  return scale_px(frame) * t * (1 + off_axis_tan * off_axis_tan) / left;
}

double angle_from_pixels(const Camera& frame, double off_axis_tan, double pixels) noexcept {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  const double reach = off_axis_tan + pixels / scale_px(frame);
  return std::atan(reach) - std::atan(off_axis_tan);
}

}  // namespace rilievo

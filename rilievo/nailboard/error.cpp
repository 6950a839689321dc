// Derived here; for S1.2, S1.3 and S1.5.
//
// In the capture's eye space let e be the frame's eye, r = (x, y, -1) a capture ray, P = d r a
// sample's true position and Q = p r where it is drawn (p = plane_z). A point A is seen in the
// frame at the pixel (X.A, Y.A) / (f.A), taken from e, with linear functionals X, Y, f: rows of the
// frame's matrix. With g = f.r and t = f.e, the weights are f.(Q - e) = p g - t, f.(P - e) = d g -
// t and
//
//   X.(Q-e) / f.(Q-e) - X.(P-e) / f.(P-e) = (X x f).((Q-e) x (P-e)) / (p g - t)(d g - t)
//
//   (Q-e) x (P-e) = (p r - e) x (d r - e) = (d - p) r x e
//
// so that the parallax in pixels is exactly
//
//   |d - p| |(X.v, Y.v)| / ((p g - t)(d g - t)),   v = r t - e g                          (1)
//
// It grows as d leaves p: d/dd (d - p) / (d g - t) = (p g - t) / (d g - t)^2 > 0; the slab's ends
// are the worst samples. |(X.v, Y.v)| is convex in (x, y), and its quotient by one of the weights,
// affine in (x, y), is quasi-convex: the largest values lie at the corners of the polygon of rays
// that the frame asks for. A bound of (1) is the largest such quotient times the largest reciprocal
// of the other weight; the weights vary little over one picture.
//
// The frame asks for a ray if any of its points between the capture's near and far plane may lie in
// the frame: the drawn place is one of them, the sample's place another. Only the drawn places
// would not do: a rectangle that has slid out of the frame would be perfect, although its objects
// belong there. Nor would the samples' places: what they hide, further back on the same rays, may
// come into the frame before they do.
//
// A moved object: any affine map only changes X, Y, f and e. Nothing else in the derivation knows
// of it.
#include "rilievo/nailboard/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/nailboard/picture_rays.h"

namespace rilievo {
namespace {

// Largest screen distance of the points `a` r and `b` r over the polygon's rays by (1), pixels.
double largest_gap(const RayPolygon& polygon, const ViewOfPicture& view, double a, double b) {
  double over_a = 0, over_b = 0, least_a = kInfinity, least_b = kInfinity;
  for (int i = 0; i < polygon.size; ++i) {
    const glm::dvec3 ray(polygon.corner[std::size_t(i)], -1);
    const double g = glm::dot(view.f, ray);
    const glm::dvec3 v = ray * view.t - view.eye * g;
    const double moment = std::hypot(glm::dot(view.x, v), glm::dot(view.y, v));
    const double at_a = a * g - view.t, at_b = b * g - view.t;
    if (at_a <= 0 || at_b <= 0) return kInfinity;
    least_a = std::min(least_a, at_a), least_b = std::min(least_b, at_b);
    over_a = std::max(over_a, moment / at_a), over_b = std::max(over_b, moment / at_b);
  }
  return std::abs(b - a) * std::min(over_a / least_b, over_b / least_a);
}

// A texel's centre A = Q + p s lies within a half texel s = (+-hx, +-hy, 0) of the point Q on the
// rectangle that a pixel b = (X.(Q-e), Y.(Q-e)) / f.(Q-e) shows. As in (1)
//
//   X.(A-e) / f.(A-e) - b_x = p (X.s - b_x f.s) / f.(A-e)
//
// convex in s and in b: the largest values are at corners.
double half_texel_px(const RayPolygon& polygon, const ViewOfPicture& view, double p,
                     const glm::dvec2& half) {
  double largest = 0, least_weight = kInfinity;
  for (int i = 0; i < polygon.size; ++i) {
    const glm::dvec3 q = glm::dvec3(polygon.corner[std::size_t(i)], -1) * p - view.eye;
    const double weight = glm::dot(view.f, q);
    if (weight <= 0) return kInfinity;
    least_weight = std::min(least_weight, weight);
    const double bx = glm::dot(view.x, q) / weight, by = glm::dot(view.y, q) / weight;
    for (double sign : {-1.0, 1.0}) {
      const glm::dvec3 s(half.x, sign * half.y, 0);
      const double fs = glm::dot(view.f, s);
      largest = std::max(largest,
                         std::hypot(glm::dot(view.x, s) - bx * fs, glm::dot(view.y, s) - by * fs));
    }
  }
  return p * largest / least_weight;
}

// A disc of radius R around c, at right angles to the capture's ray c, is turned by the angle
// between c and c - e until it faces the frame's eye e: its points move by at most 2 R sin(angle /
// 2), and sin(angle) <= |e| / |c| <= |e| / front. A point at the weight w that moves by D moves on
// the screen by at most |X - b f| D / (w - D |f|), b the pixel's place: the largest are at the
// frame's corners. A strip of n texels reaches n half texels from its middle, one of n pixels n
// / 2.
double stroke_error(const PictureGeometry& picture, const Camera& frame, const RayPolygon& asked,
                    const ViewOfPicture& view, double half_texel_px) {
  const double px = strip_shift_px(picture.strokes.texels, half_texel_px);
  if (picture.strokes.disc_radius <= 0) return px;
  const double away = glm::length(view.eye), front = picture.slab.front;
  const double moved =
      away < front ? 2 * picture.strokes.disc_radius * std::sin(0.5 * std::asin(away / front))
                   : 2 * picture.strokes.disc_radius;
  double least = kInfinity;
  for (int i = 0; i < asked.size; ++i)
    for (const double d : {picture.slab.front, picture.slab.back})
      least = std::min(least,
                       d * glm::dot(view.f, glm::dvec3(asked.corner[std::size_t(i)], -1)) - view.t);
  least -= moved * glm::length(view.f);
  if (moved > 0 && least <= 0) return kInfinity;
  const auto steepest = [&](const glm::dvec3& row, double size) {
    return std::max(glm::length(row), glm::length(row - size * view.f));
  };
  return px +
         moved / least * std::hypot(steepest(view.x, frame.width), steepest(view.y, frame.height));
}

// Half a step of Delta in window_z moves 1/d by `step` = (1/n - 1/f) / 2 steps, so that d moves by
// at most d^2 step / (1 - d step), and the sample's weight d g - t by |g| times that. d^2 / (d g -
// t) is convex in d and g / (d g - t) monotone in g: the corners and the slab's ends are the worst.
double exact_depth_error(const PictureGeometry& picture, const RayPolygon& polygon,
                         const ViewOfPicture& view) {
  if (picture.delta_bits == 0) return 0;
  const double n = picture.capture.z_near, f = picture.capture.z_far;
  const double step = 0.5 / delta_steps(picture.delta_bits) * (1 / n - 1 / f);
  const double left = 1 - picture.slab.back * step;
  if (left <= 0) return kInfinity;
  double worst = 0;
  for (int i = 0; i < polygon.size; ++i) {
    const double g = glm::dot(view.f, glm::dvec3(polygon.corner[std::size_t(i)], -1));
    for (double d : {picture.slab.front, picture.slab.back}) {
      if (d * g - view.t <= 0) return kInfinity;
      worst = std::max(worst, d * d * step / left * std::abs(g) / (d * g - view.t));
    }
  }
  return worst;
}

// Eq. (4) finds the depth between N and F, where the frame's line of sight through Q meets the
// capture's near and far planes. Along it the capture's eye_z runs from c = -e_z at the eye to p at
// Q, so that N has (n - c) / (p - c) times Q's weight, F likewise, and, screen depth being affine
// in 1/weight,
//
//   1 / drawn = (p - c) h / (p g - t),   h = (1 - Delta) / (n - c) + Delta / (f - c) = A + B/d
//   drawn / true = (p g - t) / ((p - c) h (d g - t))                                     (2)
//
// For e = 0 this is 1: eq. (4) is exact under a rotation about the eye. (2) is monotone in g, and
// stationary in d where d^2 = -t B / (A g). Half a step of Delta changes h by `eta`.
double linear_depth_error(const PictureGeometry& picture, const RayPolygon& polygon,
                          const ViewOfPicture& view) {
  const double n = picture.capture.z_near, f = picture.capture.z_far, p = picture.plane_z;
  const double c = -view.eye.z;
  if (c >= n || c >= p) return kInfinity;
  const double depth = 1 / n - 1 / f, k = 1 / (f - c) - 1 / (n - c);
  const double a = 1 / (n - c) + k / (n * depth), b = -k / depth;
  const double half_step = picture.delta_bits == 0 ? 0 : 0.5 / delta_steps(picture.delta_bits);
  const double least_h = std::min(a + b / picture.slab.front, a + b / picture.slab.back);
  const double eta = half_step * std::abs(k);
  if (least_h <= eta) return kInfinity;

  double worst = 0, largest_ratio = 0;
  for (int i = 0; i < polygon.size; ++i) {
    const double g = glm::dot(view.f, glm::dvec3(polygon.corner[std::size_t(i)], -1));
    const double square = -view.t * b / (a * g);
    const double stationary =
        square > 0 ? std::clamp(std::sqrt(square), picture.slab.front, picture.slab.back)
                   : picture.slab.front;
    for (double d : {picture.slab.front, stationary, picture.slab.back}) {
      const double weight = p * g - view.t, true_weight = d * g - view.t;
      if (weight <= 0 || true_weight <= 0) return kInfinity;
      const double ratio = weight / ((p - c) * (a + b / d) * true_weight);
      worst = std::max(worst, std::abs(ratio - 1));
      largest_ratio = std::max(largest_ratio, ratio);
    }
  }
  return worst + largest_ratio * eta / (least_h - eta);
}

// A flat impostor writes the weight p g - t of its rectangle. The difference grows as d leaves p
// and is monotone in g.
double flat_depth_error(const PictureGeometry& picture, const RayPolygon& polygon,
                        const ViewOfPicture& view) {
  double worst = 0;
  for (int i = 0; i < polygon.size; ++i) {
    const double g = glm::dot(view.f, glm::dvec3(polygon.corner[std::size_t(i)], -1));
    for (double d : {picture.slab.front, picture.slab.back}) {
      if (d * g - view.t <= 0) return kInfinity;
      worst = std::max(worst, std::abs((d - picture.plane_z) * g) / (d * g - view.t));
    }
  }
  return worst;
}

double depth_error(const PictureGeometry& picture, const RayPolygon& polygon,
                   const ViewOfPicture& view) {
  switch (picture.depth_mode) {
    case DepthMode::flat:
      return flat_depth_error(picture, polygon, view);
    case DepthMode::linear:
      return linear_depth_error(picture, polygon, view);
    case DepthMode::exact:
      return exact_depth_error(picture, polygon, view);
  }
  return kInfinity;
}

// The least weight of the rectangle's points on these rays: their distance from the frame's eye
// along its line of sight.
double least_weight(const RayPolygon& polygon, const ViewOfPicture& view, double p) {
  double least = kInfinity;
  for (int i = 0; i < polygon.size; ++i)
    least = std::min(least,
                     p * glm::dot(view.f, glm::dvec3(polygon.corner[std::size_t(i)], -1)) - view.t);
  return least;
}

// Fills in what concerns the screen position; yields the rays that are drawn in the frame.
RayPolygon screen_error(const PictureGeometry& picture, const Camera& frame,
                        const ViewOfPicture& view, PictureError& error) {
  const Camera& capture = picture.capture;
  RILIEVO_EXPECTS(capture.projection == Projection::perspective);
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  RILIEVO_EXPECTS_LE(picture.slab.front, picture.plane_z);
  RILIEVO_EXPECTS_LE(picture.plane_z, picture.slab.back);
  const ImageWindow& w = capture.window;
  const glm::dvec2 half(0.5 * (w.right - w.left) / capture.width,
                        0.5 * (w.top - w.bottom) / capture.height);
  const double p = picture.plane_z;
  const RayPolygon asked =
      rays_in_frame(picture, frame, view, std::min(capture.z_near, picture.slab.front),
                    std::max(capture.z_far, picture.slab.back), half);
  if (asked.size == 0) return asked;
  error.in_frame = true;
  const RayPolygon drawn = rays_in_frame(picture, frame, view, p, p, half);
  const double texel_px = drawn.size > 0 ? half_texel_px(drawn, view, p, half) : 0;
  error.magnification_px = std::max(0.0, texel_px - std::sqrt(0.5));
  if (picture.strokes.any()) error.stroke_px = stroke_error(picture, frame, asked, view, texel_px);
  // What the near plane cuts off the rectangle is not drawn anywhere.
  error.parallax_px = least_weight(asked, view, p) < frame.z_near
                          ? kInfinity
                          : std::max(largest_gap(asked, view, p, picture.slab.front),
                                     largest_gap(asked, view, p, picture.slab.back));
  error.total_px = error.parallax_px + error.magnification_px + error.stroke_px;
  return drawn;
}

}  // namespace

PictureError bound_error(const PictureGeometry& picture, const Camera& frame,
                         const RigidMotion& motion) {
  if (!is_rigid(motion.now_from_then))
    return {true, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity};
  const ViewOfPicture view = view_of(frame, picture, motion);
  PictureError error;
  // What is missing is missed where it truly is, not on the flat rectangle.
  const DepthSlab& slab = picture.slab;
  const RayPolygon hidden = rays_in_frame(picture, frame, view, slab.front, slab.back, {0, 0});
  if (hidden.size > 0) error.disocclusion_px = largest_gap(hidden, view, slab.front, slab.back);

  const RayPolygon drawn = screen_error(picture, frame, view, error);
  if (drawn.size > 0) error.depth_relative = depth_error(picture, drawn, view);
  return error;
}

double bound_total_px(const PictureGeometry& picture, const Camera& frame,
                      const RigidMotion& motion) {
  if (!is_rigid(motion.now_from_then)) return kInfinity;
  PictureError error;
  screen_error(picture, frame, view_of(frame, picture, motion), error);
  return error.total_px;
}

}  // namespace rilievo

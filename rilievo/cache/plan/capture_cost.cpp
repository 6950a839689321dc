// How long a picture lives, from the formula of nailboard/error.cpp:
//
//   parallax px = |d - p| |(X.v, Y.v)| / ((p g - t)(d g - t)),   v = r (f.e) - e (f.r)
//
// For a capture camera parallel to the frame's g = 1, and for an eye that moves by `drift` a frame,
// to first order,
//
//   px a frame = (1/front - 1/back)/2 |(px (x drift_z - drift_x), py (y drift_z - drift_y))|
//
// at the picture's ray (x, y): the depth's share of the optical flow. It is largest at a corner.
#include "rilievo/cache/plan/capture_cost.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/picture_camera.h"
#include "rilievo/core/box_distance.h"

namespace rilievo {
namespace {

// A picture as wide as this tangent is taken from too near.
constexpr double kWidest = 2.5;
// While a picture is in use the eye comes nearer by at most this share of the distance: texels
// need not be smaller than pixels by more.
constexpr double kApproach = 0.3;
// And it goes away by at most this share, so that kMostMinified is not reached before.
constexpr double kRecede = 0.4;
constexpr double kShortestLife = 2;  // frames; what lives shorter is captured for one frame

std::array<ViewAxes::Plane, 5> sides_of(const Camera& camera) {
  const glm::dvec3 eye = camera.position();
  const glm::dvec3 right(camera.world_from_eye[0]), up(camera.world_from_eye[1]);
  const glm::dvec3 forward = camera.forward();
  const ImageWindow& w = camera.window;
  const std::array<glm::dvec3, 5> normals{right - w.left * forward, w.right * forward - right,
                                          up - w.bottom * forward, w.top * forward - up, forward};
  std::array<ViewAxes::Plane, 5> planes;
  for (std::size_t i = 0; i < 5; ++i)
    planes[i] = {normals[i], glm::dot(normals[i], eye) + (i == 4 ? camera.z_near : 0.0)};
  return planes;
}

// The box from an eye that looks along the frame's axes.
struct Seen {
  double front, back;
  ImageWindow window;  // meaningful if front > 0
};

Seen see(const ViewAxes& view, const Box& box, const glm::dvec3& eye) {
  const glm::dvec3 center = glm::dvec3(box.center()) - eye;
  const glm::dvec3 half = 0.5 * glm::dvec3(box.extent());
  const glm::dvec3 at(glm::dot(center, view.right), glm::dot(center, view.up),
                      glm::dot(center, view.forward));
  std::array<glm::dvec3, 3> axis;  // half edges in the frame's axes
  for (int k = 0; k < 3; ++k)
    axis[std::size_t(k)] = half[k] * glm::dvec3(view.right[k], view.up[k], view.forward[k]);
  const double reach = std::abs(axis[0].z) + std::abs(axis[1].z) + std::abs(axis[2].z);
  Seen seen{at.z - reach, at.z + reach, {1e300, -1e300, 1e300, -1e300}};
  if (seen.front <= 0) return seen;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 p = at + (i & 1 ? axis[0] : -axis[0]) + (i & 2 ? axis[1] : -axis[1]) +
                         (i & 4 ? axis[2] : -axis[2]);
    const double x = p.x / p.z, y = p.y / p.z;
    seen.window.left = std::min(seen.window.left, x);
    seen.window.right = std::max(seen.window.right, x);
    seen.window.bottom = std::min(seen.window.bottom, y);
    seen.window.top = std::max(seen.window.top, y);
  }
  return seen;
}

// A frame and a margin, of what is captured for few frames.
ImageWindow around(const ImageWindow& w) {
  constexpr double kMargin = 0.15;
  const double x = kMargin * (w.right - w.left), y = kMargin * (w.top - w.bottom);
  return {w.left - x, w.right + x, w.bottom - y, w.top + y};
}

ImageWindow intersection(const ImageWindow& a, const ImageWindow& b) {
  return {std::clamp(a.left, b.left, b.right), std::clamp(a.right, b.left, b.right),
          std::clamp(a.bottom, b.bottom, b.top), std::clamp(a.top, b.bottom, b.top)};
}

double area(const ImageWindow& w) { return (w.right - w.left) * (w.top - w.bottom); }

}  // namespace

Camera camera_ahead(const FrameView& view, double frames) {
  Camera camera = view.camera;
  const double angle = glm::length(view.turn) * frames;
  if (angle > 0)
    camera.world_from_eye =
        glm::rotate(glm::dmat4(1), angle, glm::normalize(view.turn)) * camera.world_from_eye;
  camera.world_from_eye[3] = glm::dvec4(view.camera.position() + view.velocity * frames, 1);
  return camera;
}

ViewAxes view_axes(const FrameView& view, double frames_ahead) {
  ViewAxes axes;
  const Camera& c = view.camera;
  axes.camera = c;
  axes.eye = c.position();
  axes.right = glm::dvec3(c.world_from_eye[0]);
  axes.up = glm::dvec3(c.world_from_eye[1]);
  axes.forward = c.forward();
  axes.velocity = view.velocity;
  axes.px = c.width / (c.window.right - c.window.left);
  axes.py = c.height / (c.window.top - c.window.bottom);
  axes.now = sides_of(c);
  axes.ahead = sides_of(camera_ahead(view, frames_ahead));
  return axes;
}

bool may_see(const std::array<ViewAxes::Plane, 5>& frustum, const Box& box) {
  const glm::dvec3 center(box.center()), half = 0.5 * glm::dvec3(box.extent());
  for (const ViewAxes::Plane& plane : frustum)
    if (glm::dot(plane.normal, center) + glm::dot(glm::abs(plane.normal), half) < plane.offset)
      return false;
  return true;
}

double minification(const PictureGeometry& picture, const Camera& frame) {
  const Camera& capture = picture.capture;
  const ImageWindow &w = capture.window, &f = frame.window;
  const glm::dvec3 middle(0.5 * (w.left + w.right), 0.5 * (w.bottom + w.top), -1);
  const glm::dvec3 at(capture.world_from_eye * glm::dvec4(picture.plane_z * middle, 1));
  const double distance = glm::dot(at - frame.position(), frame.forward());
  if (distance <= 0) return 1;
  const double texel = picture.plane_z * std::min((w.right - w.left) / capture.width,
                                                  (w.top - w.bottom) / capture.height);
  const double pixel =
      distance * std::max((f.right - f.left) / frame.width, (f.top - f.bottom) / frame.height);
  return pixel / texel;
}

// A point p that is drawn at q, |q - p| = error, appears off by |(q - p).xy - t (q - p).z| / p.z
// with q's tangent t in the frame: at most error sqrt(1 + t^2) / p.z. Both are in the box.
double level_px(const Camera& frame, const Box& box, double error) {
  if (!(error > 0)) return 0;
  ViewAxes axes;
  axes.right = glm::dvec3(frame.world_from_eye[0]);
  axes.up = glm::dvec3(frame.world_from_eye[1]);
  axes.forward = frame.forward();
  const auto square_of = [](const ImageWindow& w) {
    const double x = std::max(-w.left, w.right), y = std::max(-w.bottom, w.top);
    return x * x + y * y;
  };
  // What is in the frame is no farther from its axis than the corner.
  const glm::dvec3 eye = frame.position();
  const double away = distance_to(box, eye);
  double square = square_of(frame.window);
  double depth = away / std::sqrt(1 + square) - error;
  if (const Seen seen = see(axes, box, eye); seen.front > 0) {
    depth = std::max(depth, seen.front);
    square = square_of(intersection(seen.window, frame.window));
  }
  if (!(depth > 0)) return INFINITY;
  const ImageWindow& w = frame.window;
  const double px = std::max(frame.width / (w.right - w.left), frame.height / (w.top - w.bottom));
  return px * error * std::sqrt(1 + square) / depth;
}

ImageWindow covered_window(const ViewAxes& view, const Box& box) {
  const Seen seen = see(view, box, view.eye);
  const ImageWindow& frame = view.camera.window;
  return seen.front > 0 ? intersection(seen.window, frame) : frame;
}

double covered_pixels(const ViewAxes& view, const Box& box) {
  return view.px * view.py * area(covered_window(view, box));
}

bool shows_frame(const Camera& capture, const Camera& frame, const Box& box) {
  // The frame's frustum in the box's range of depths is the hull of eight corners.
  const glm::dvec3 center = glm::dvec3(box.center()) - frame.position(), forward = frame.forward();
  const double middle = glm::dot(center, forward);
  const double reach = 0.5 * glm::dot(glm::dvec3(box.extent()), glm::abs(forward));
  if (middle + reach <= frame.z_near) return true;
  const glm::dmat4 eye_from_world = glm::inverse(capture.world_from_eye);
  const ImageWindow &f = frame.window, &w = capture.window;
  for (const double depth : {std::max(frame.z_near, middle - reach), middle + reach})
    for (const double x : {f.left, f.right})
      for (const double y : {f.bottom, f.top}) {
        const glm::dvec4 p =
            eye_from_world * (frame.world_from_eye * glm::dvec4(x * depth, y * depth, -depth, 1));
        if (!(p.z < 0)) return false;
        const double u = p.x / -p.z, v = p.y / -p.z;
        if (u < w.left || u > w.right || v < w.bottom || v > w.top) return false;
      }
  return true;
}

CaptureCost estimate_capture_cost(const ViewAxes& view, const Box& box, std::uint64_t triangles,
                                  const glm::dvec3& drift, const CacheOptions& options,
                                  const DeltaRange& range, double life_share, double level_px) {
  CaptureCost e;
  e.triangles = triangles, e.level_px = level_px;
  const Seen seen = see(view, box, view.eye);
  if (seen.front <= view.camera.z_near) return e;
  const ImageWindow& w = seen.window;
  if (std::max({-w.left, w.right, -w.bottom, w.top}) > kWidest) return e;

  const ImageWindow visible = intersection(w, view.camera.window);
  const glm::dvec3 d(glm::dot(drift, view.right), glm::dot(drift, view.up),
                     glm::dot(drift, view.forward));
  double flow = 0;
  for (double x : {visible.left, visible.right})
    for (double y : {visible.bottom, visible.top})
      flow = std::max(flow, std::hypot(view.px * (x * d.z - d.x), view.py * (y * d.z - d.y)));
  const DepthSlab slab = part_of({seen.front, seen.back}, range);
  const double per_frame = 0.5 * (1 / slab.front - 1 / slab.back) * flow;
  e.life = kLongestLife;
  const double allowed_px = (options.error_px - level_px) * life_share;
  if (per_frame * e.life > allowed_px) e.life = allowed_px / per_frame;
  // The eye comes nearer twice as long: before the capture's eye and after.
  const double approach = std::max(0.0, d.z) * (1 + kAnticipation);
  if (approach * e.life > kApproach * seen.front) e.life = kApproach * seen.front / approach;
  const double recede = std::max(0.0, -d.z) * (1 + kAnticipation);
  if (recede * e.life > kRecede * seen.front) e.life = kRecede * seen.front / recede;
  e.once = e.life * (1 + kAnticipation) < kShortestLife;
  if (e.once) e.life = 1 / (1 + kAnticipation);
  e.ahead = e.once ? 0 : kAnticipation * e.life;

  // The plane's distance now, from the capture's eye, and at the end.
  const double plane = best_plane(slab);
  const double captured = plane - d.z * e.ahead, last = plane - d.z * (e.ahead + e.life);
  e.density = captured / std::min(plane, last);
  const ImageWindow near_frame = intersection(w, around(view.camera.window));
  e.texels_in_frame = view.px * view.py * area(near_frame);
  if (e.once) e.density = 1;
  const double finer = e.once ? 1 : plane / std::min(plane, last);
  const ImageWindow& shown = e.once ? near_frame : w;
  const double texels_x = (shown.right - shown.left) * view.px * finer;
  const double texels_y = (shown.top - shown.bottom) * view.py * finer;
  if (std::max(texels_x, texels_y) > options.max_texels - 2) return e;
  e.texels = texels_x * texels_y;

  const CostModel& cost = options.cost;
  e.draw = cost.picture + cost.picture_pixel * view.px * view.py * area(visible);
  e.capture =
      cost.capture + cost.capture_triangle * double(triangles) + cost.capture_texel * e.texels;
  e.possible = true;
  return e;
}

PlacedPicture place_picture(const ViewAxes& view, const Box& box, const CaptureCost& estimate,
                            const glm::dvec3& drift, double texel_scale,
                            const CacheOptions& options, const DeltaRange& range, bool clip) {
  PlacedPicture placed;
  // Texels larger than pixels from the start, where memory is short, are allowed for.
  placed.coarse_px = std::sqrt(0.5) * (1 / texel_scale - 1);
  double ahead = estimate.ahead;
  for (int attempt = 0; attempt < 5 && !placed.good;
       ++attempt, ahead = attempt < 4 ? ahead / 2 : 0) {
    const glm::dvec3 eye = view.eye + drift * ahead;
    const Seen seen = see(view, box, eye);
    if (!(seen.front > 0)) continue;  // nor where the drift is not a number
    Camera camera = view.camera;
    camera.world_from_eye[3] = glm::dvec4(eye, 1);
    camera.window = seen.window;
    if (clip) camera.window = intersection(seen.window, around(view.camera.window));
    placed.clipped = clip && area(camera.window) < area(seen.window);
    const double density = estimate.density * texel_scale;
    align_to_texels(view.camera.window.left, 1 / (view.px * density), camera.window.left,
                    camera.window.right, camera.width);
    align_to_texels(view.camera.window.bottom, 1 / (view.py * density), camera.window.bottom,
                    camera.window.top, camera.height);
    if (std::max(camera.width, camera.height) > options.max_texels) continue;
    // Surfaces that touch the box must not be clipped by rounding.
    const double slack = 1e-4 * std::max(seen.back - seen.front, 1e-3 * seen.back);
    camera.z_near = std::max(seen.front - slack, 0.5 * seen.front);
    camera.z_far = seen.back + slack;
    placed.geometry = picture_geometry(camera);
    placed.geometry.delta_bits = options.delta_bits;
    placed.geometry.depth_mode = options.depth_mode;
    PictureGeometry expected = placed.geometry;
    narrow_slab(expected, range);
    placed.good = bound_total_px(expected, view.camera) + estimate.level_px <=
                  options.error_px + placed.coarse_px;
  }
  return placed;
}

}  // namespace rilievo

// What would a picture of this box cost, and for how long would it live?
//
// Estimates for choosing, a few dozen operations each; whether a picture may be drawn is decided by
// bound_total_px alone. World space, metres, frames.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "rilievo/cache/policy.h"

namespace rilievo {

// The frame's camera taken apart, and where it will be some frames ahead.
struct ViewAxes {
  Camera camera;
  glm::dvec3 eye, right, up, forward, velocity;
  double px = 1, py = 1;  // pixels per tangent
  struct Plane {
    glm::dvec3 normal;  // inwards
    double offset;      // inside: dot(normal, p) >= offset
  };
  std::array<Plane, 5> now, ahead;  // of the frustum, without its far plane
};

// The camera `frames` from now if the motion goes on.
[[nodiscard]] Camera camera_ahead(const FrameView& view, double frames);

[[nodiscard]] ViewAxes view_axes(const FrameView& view, double frames_ahead);

// May the box be in the frustum? False only if it is not.
[[nodiscard]] bool may_see(const std::array<ViewAxes::Plane, 5>& frustum, const Box& box);

struct PictureEstimate {
  bool possible = false;  // not too near, not too large, not too short-lived
  double life = 0;        // frames until the error passes the limit, for an eye at the capture's
  double draw = 0, capture = 0;  // triangles
  // Frames ahead of now for which the picture should be captured.
  double ahead = 0;
  double texels = 0;
  double density = 1;  // texels per pixel: texels will not have outgrown pixels when it ends
};

// `drift`: metres that the eye moves against the object in a frame. `range`: which part of the
// box's depths the picture is expected to show. `life_share`: of the life that its flatness allows,
// what its gaps are expected to leave.
[[nodiscard]] PictureEstimate estimate_picture(const ViewAxes& view, const Box& box,
                                               std::uint64_t triangles, const glm::dvec3& drift,
                                               const CacheOptions& options,
                                               const DeltaRange& range = {}, double life_share = 1);

// Rate of a picture that is captured over and over again: triangles a frame.
[[nodiscard]] inline double picture_rate(const PictureEstimate& e, const CacheOptions& options) {
  return e.draw + e.capture / ((1 + options.anticipation) * e.life);
}

// Pixels of the frame within the rectangle around the box; of the whole frame if it is too near.
[[nodiscard]] double covered_pixels(const ViewAxes& view, const Box& box);

// The picture itself: a camera whose axes are the frame's, so that texels lie as pixels do, tight
// around the box, as far ahead of the frame's eye as keeps it within the limit now.
struct PlacedPicture {
  PictureGeometry geometry;
  double coarse_px = 0;  // by which it may pass error_px: texels made too coarse
  bool good = false;     // within the limit now, if the picture shows what is expected
};
[[nodiscard]] PlacedPicture place_picture(const ViewAxes& view, const Box& box,
                                          const PictureEstimate& estimate, const glm::dvec3& drift,
                                          double texel_scale, const CacheOptions& options,
                                          const DeltaRange& range = {});

[[nodiscard]] inline std::uint64_t picture_bytes(const Camera& camera,
                                                 const CacheOptions& options) {
  const auto cells = [&](int texels) {
    return std::uint64_t((texels + options.texel_cell - 1) / options.texel_cell) *
           std::uint64_t(options.texel_cell);
  };
  return cells(camera.width) * cells(camera.height) * std::uint64_t(options.bytes_per_texel);
}

}  // namespace rilievo

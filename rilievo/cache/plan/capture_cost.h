// The cost of a picture of a box, and how long it will live.
//
// Estimates for choosing, a few dozen operations each. Whether a picture can be drawn is decided by
// bound_total_px and bound_gap_px (nailboard/error.h, gap_table.h). World space, metres, frames.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "rilievo/cache/plan/policy.h"

namespace rilievo {

// The frame's camera, decomposed, now and some frames ahead.
struct ViewAxes {
  Camera camera;
  glm::dvec3 eye, right, up, forward, velocity;
  double px = 1, py = 1;  // pixels per tangent
  // A half space: dot(normal, p) >= offset.
  struct Plane {
    glm::dvec3 normal;  // inwards
    double offset;      // inside: dot(normal, p) >= offset
  };
  std::array<Plane, 5> now, ahead;  // the frustum without its far plane
};

// The camera after `frames` frames, if the motion continues.
[[nodiscard]] Camera camera_ahead(const FrameView& view, double frames);

// The view now and `frames_ahead` frames ahead.
[[nodiscard]] ViewAxes view_axes(const FrameView& view, double frames_ahead);

// Does the box intersect the frustum? Conservative: false only if it does not.
[[nodiscard]] bool may_see(const std::array<ViewAxes::Plane, 5>& frustum, const Box& box);

// The estimate for one picture. Costs are in triangles.
struct CaptureCost {
  bool possible = false;         // not too near, not too large
  bool once = false;             // lasts so briefly that it is captured for one frame alone
  double life = 0;               // frames until the error exceeds the limit
  double draw = 0, capture = 0;  // triangles
  // For how many frames ahead the picture should be captured.
  double ahead = 0;
  double texels = 0;
  double texels_in_frame = 0;  // of a picture of the part near the frame, one for each pixel
  std::uint64_t triangles = 0;
  double level_error = 0, level_px = 0;  // of levels of detail, metres and in this frame
  double density = 1;  // texels per pixel at capture, so that texels do not exceed pixels later
};

// Estimates a picture of `box`. `drift`: the eye's motion relative to the object, metres per frame.
// `range`: the part of the box's depths that the picture is expected to show. `life_share`: the
// share of the life that flatness allows which gaps are expected to leave. `level_px`: the part of
// error_px that the triangles' level of detail takes.
[[nodiscard]] CaptureCost estimate_capture_cost(const ViewAxes& view, const Box& box,
                                                std::uint64_t triangles, const glm::dvec3& drift,
                                                const CacheOptions& options,
                                                const DeltaRange& range = {}, double life_share = 1,
                                                double level_px = 0);

// The cost per frame of a picture that is captured again and again, in triangles.
[[nodiscard]] inline double picture_rate(const CaptureCost& e) {
  return e.draw + e.capture / ((1 + kAnticipation) * e.life);
}

// How far off can a surface appear in the frame, in pixels, that is drawn `error` metres off within
// the box? Infinite where it can be behind the eye.
[[nodiscard]] double level_px(const Camera& frame, const Box& box, double error);

// How many texels does a pixel step over, where the frame sees the middle of the picture's polygon?
// Above kMostMinified what is between them shows as aliasing. For cameras that look alike; 1 where
// the polygon is behind the frame's eye.
inline constexpr double kMostMinified = 1.5;
[[nodiscard]] double minification(const PictureGeometry& picture, const Camera& frame);

// The part of the frame's window around the box; all of it if the box is too near.
[[nodiscard]] ImageWindow covered_window(const ViewAxes& view, const Box& box);
// The number of its pixels.
[[nodiscard]] double covered_pixels(const ViewAxes& view, const Box& box);

// The geometry for a capture. The camera has the frame's axes, so that texels align with pixels, is
// tight around the box, and stands as far ahead of the frame's eye as the error limit allows now.
struct PlacedPicture {
  PictureGeometry geometry;
  double coarse_px = 0;  // the excess over error_px that coarse texels cause
  bool clipped = false;  // shows only the part near the frame
  bool good = false;     // within the limit now, if the picture shows the expected range
};
// Places a picture; see estimate_capture_cost. `texel_scale` below 1 makes texels coarser. With
// `clip` the picture ends a margin outside the frame.
[[nodiscard]] PlacedPicture place_picture(const ViewAxes& view, const Box& box,
                                          const CaptureCost& estimate, const glm::dvec3& drift,
                                          double texel_scale, const CacheOptions& options,
                                          const DeltaRange& range = {}, bool clip = false);

// Does a clipped picture of what is in `box` show all that `frame` sees of it? Conservative.
[[nodiscard]] bool shows_frame(const Camera& capture, const Camera& frame, const Box& box);

// The memory of a picture in the atlas.
[[nodiscard]] inline std::uint64_t picture_bytes(const Camera& camera,
                                                 const CacheOptions& options) {
  const auto cells = [&](int texels) {
    return std::uint64_t((texels + options.texel_cell - 1) / options.texel_cell) *
           std::uint64_t(options.texel_cell);
  };
  return cells(camera.width) * cells(camera.height) * std::uint64_t(options.bytes_per_texel);
}

}  // namespace rilievo

// The texel rule: which of a texel's samples show the surface that the texel shows.
//
// A texel has one depth, so it is one piece of surface, and moves with it. What its other samples
// saw belongs to other surfaces, and must not move with this one: a lamp's colour that stays on the
// wall behind is a second outline of the lamp, once the two move apart. Therefore:
//
// - A texel shows the surface at its centre. Where that is behind (or nothing), and a surface in
//   front is thinner than two texels and covers the centre of no texel across it, but half a texel
//   of samples, then the texel with most of those samples shows the thin surface: a cable of half a
//   texel's width is a chain of texels without a gap. Within two texels of an end of that surface,
//   a texel shows it only if half of the texel's samples do; a surface shorter than three texels
//   shows in none.
// - Its colour is the mean of the samples of that surface, and of those that it hides in part.
//   A sample shows the surface if it is of the same object and lies near the plane through the
//   texel's centre: within three texels' widths (what warps link in any case) and half of the
//   plane's own slope. A sample behind that plane is hidden in part: an edge is so antialiased,
//   and what is behind it never has its colour. If no sample shows the surface, the texel has the
//   surface's colour at the centre.
//
// The plane comes from the centres of neighbouring texels. Depths are given as nearness, which is
// affine over the raster on a plane, so that the ground is one surface up to the horizon. The plane
// has the smaller of the two steps to neighbours on either side, and no slope where these
// have opposite signs: across a silhouette one step leads to another surface.
//
// All sources of pictures share this. Pure; any thread; rows in any order, the same one for texels
// and for places of samples.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/image.h"

namespace rilievo {

// The nearness of nothing.
inline constexpr float kNoNearness = -std::numeric_limits<float>::infinity();

// How a camera's depths become nearness, which is affine over the raster on a plane and is larger
// nearer to the viewer: 1 / eye_z of a perspective camera, -1 / eye_z of a back-perspective one,
// -eye_z of a parallel one.
struct Nearness {
  explicit Nearness(const Camera& camera);

  [[nodiscard]] float of_eye_z(double eye_z) const;
  [[nodiscard]] float of_window_z(float window_z) const {
    return float(at_near + double(window_z) * (at_far - at_near));
  }
  [[nodiscard]] double eye_z(float nearness) const;
  // By how much nearness changes over a texel's width of depth.
  [[nodiscard]] float texel(float nearness) const {
    return projection == Projection::parallel ? texel_width : texel_width * std::abs(nearness);
  }

  Projection projection = Projection::perspective;
  double at_near = 0, at_far = 0;  // on the planes of the frustum
  float texel_width = 0;           // at depth 1; of a parallel camera in metres
  float noise = 0;                 // of nearness, where window_z is a float
};

// What the centres and the samples of a picture's texels show.
struct TexelSamples {
  // A picture without surfaces; `places` are those of the samples from the texel's centre, in
  // texels, at most 8.
  TexelSamples(const Camera& camera, std::span<const glm::vec2> places);

  [[nodiscard]] int samples() const { return int(places.size()); }
  [[nodiscard]] std::size_t first(int x, int y) const {
    return (std::size_t(y) * std::size_t(center.width()) + std::size_t(x)) * places.size();
  }

  Nearness nearness;
  std::vector<glm::vec2> places;
  Image<float> center;                 // nearness, kNoNearness where nothing is
  Image<std::uint32_t> center_object;  // kNoObject where nothing is
  std::vector<float> sample;           // from first(x, y) on, so many for each texel
  std::vector<std::uint32_t> sample_object;
};

// A texel that shows a thin surface in front of what its centre shows.
struct ThinTexel {
  int x = 0, y = 0;
  float nearness = 0;
  std::uint32_t object = 0;
};

// What texels show.
struct ShownSamples {
  // A bit for each sample whose colour counts; 0: only the centre's does, or nothing's.
  Image<std::uint8_t> mask;
  std::vector<ThinTexel> thin;  // row by row
};

// Applies the rule. The result does not depend on the number of threads.
[[nodiscard]] ShownSamples choose_samples(const TexelSamples& texels);

// The plane through a texel's centre.
struct TexelPlane {
  float nearness = kNoNearness, per_x = 0, per_y = 0;  // a texel
  float room = 0;                                      // to either side of the plane
  std::uint32_t object = 0;

  // Does a sample at `from_center` show this surface?
  [[nodiscard]] bool shows(const glm::vec2& from_center, float sample,
                           std::uint32_t sample_object) const {
    const float x = per_x * from_center.x, y = per_y * from_center.y;
    return sample_object == object &&
           std::abs(sample - nearness - x - y) <= room + 0.5f * (std::abs(x) + std::abs(y));
  }
  // Or does it show something behind it?
  [[nodiscard]] bool hides(const glm::vec2& from_center, float sample) const {
    return sample != kNoNearness &&
           sample < nearness + per_x * from_center.x + per_y * from_center.y - room;
  }
};
// The plane of a texel whose centre shows something. `objects` may be empty.
[[nodiscard]] TexelPlane texel_plane(const Nearness& nearness, const Image<float>& center,
                                     const Image<std::uint32_t>& objects, int x, int y);

}  // namespace rilievo

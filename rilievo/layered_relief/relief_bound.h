// How far from where it belongs may a set of reliefs show a sample, in pixels? And which of the
// reliefs is the one for an eye? (S4.4)
//
// Plain data, so that a cache may ask in every frame, from any thread: the directions that the
// reliefs face, how large their texels are, what was given up to make them. The hull of
// each relief is taken to be the box around all samples. For frames
// whose eye the reliefs are warped for. Less the half diagonal of a pixel, as for every kind: a
// pixel's centre q that shows a sample whose place is s has |q - s| <= bound + sqrt(1/2).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "rilievo/core/bounds.h"
#include "rilievo/core/stroke_size.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/relief_set.h"

namespace rilievo {

// What the bound of a set of reliefs depends on.
struct ReliefStats {
  static constexpr int kMaxCount = 32;
  int count = 0;
  int max_size = 0;  // of the result, texels a side
  // Where reliefs look, in 1 / 32767; where their planes stand: along it, from the centre of the
  // bounds, in 1 / 32767 of the radius.
  std::array<std::array<std::int16_t, 3>, kMaxCount> forward{};
  std::array<std::int16_t, kMaxCount> plane{};
  float largest_texel = 0, least_texel = 0;  // a side, metres
  float depth = 0;                           // merged and rounded, metres
  float moved = 0;                           // before they came, metres
  float lacks = 0;                           // as ReliefPictures::Picture's; 0: not known
  float splat_size = 1, resolution = 1;
  float faces_eye = 0;     // 1: PrewarpOptions::splats_face_eye
  float texel_px = 0.75f;  // the result's texels are averaged until they are nearly as large
  float disc_radius = 0, stroke_texels = 0;  // StrokeSize's
};

// `moved`, `lacks`: the largest of the pictures'. At most kMaxCount reliefs, all parallel; of
// perspective ones nothing is known, and stats of none are returned.
[[nodiscard]] ReliefStats relief_stats(const ReliefSet& set, const Box& bounds, double moved,
                                       const PrewarpOptions& options, double lacks = 0,
                                       const StrokeSize& strokes = {});

// The relief that faces `eye` most, of those that can surely be warped for it; -1: none. `bounds`
// as for relief_stats.
[[nodiscard]] int pick_relief(const ReliefStats& stats, const Box& bounds, const glm::dvec3& eye);

// The frame's camera as it stands to what was captured; nothing if the motion is neither rigid nor
// a uniform scale. Metres of the capture.
[[nodiscard]] std::optional<Camera> camera_at_capture(const Camera& frame,
                                                      const glm::dmat4& world_from_capture);
// The size of a metre of the capture.
[[nodiscard]] double scale_of(const glm::dmat4& world_from_capture);

// Infinite if no relief can surely be warped. `camera` at capture, perspective. About a
// microsecond.
[[nodiscard]] double relief_bound_px(const ReliefStats& stats, const Box& bounds,
                                     const Camera& camera);

// An upper bound of the width of cracks, pixels: strips that should show a surface wider than that
// and have no sample of it. Infinite if no relief can surely be warped, and if nothing is known of
// cracks (ReliefPictures::Picture::lacks is 0). Less a pixel's diagonal: around each place at which
// a surface is to be seen, a pixel's centre within gap / 2 + sqrt(1/2) shows it, or what hides it.
[[nodiscard]] double relief_gap_px(const ReliefStats& stats, const Box& bounds,
                                   const Camera& camera);

// How many times the texels of a result, `texel_px` pixels large, may be averaged by two.
[[nodiscard]] int relief_level(double texel_px, double most_px);

}  // namespace rilievo

// What does an eye see of a layered relief, as a flat picture on the relief's source plane, or in
// the directions of a perspective relief's texels?
// (S4.2, S4.3, S4.5 to S4.8, S4.10)
//
// The result is a nailboard as if captured by the eye itself: its camera stands at the eye and
// looks perpendicularly at the source plane, its window is the rectangle there that the samples
// cover, and its Deltas are their depths. Any nailboard drawer draws it, from this eye without
// parallax.
//
// Result space: texels of the source times `resolution`. Tiles are warped in parallel and share
// nothing: the result depends neither on the number of threads nor on the instruction set.
#pragma once

#include <memory>
#include <optional>

#include "rilievo/core/picture_geometry.h"
#include "rilievo/layered_relief/layered_relief.h"
#include "rilievo/nailboard/nailboard.h"
#include "rilievo/nailboard/prewarped.h"

namespace rilievo {

// The footprint of a sample in the result.
enum class Splat {
  nearest,    // the texel at the sample's centre
  rectangle,  // the texels within the sample's source texel, moved and scaled (S4.5)
};

// No sample is warped that this magnifies more: the eye is too near to it, or before it.
constexpr double kMaxPrewarpMagnification = 64;

// The splats and the size of the result.
struct PrewarpOptions {
  Splat splat = Splat::rectangle;
  // The side of a splat in source texels. With 1, splats of equal depth meet exactly and hide
  // nothing that they should not; with 2 (the paper's), surfaces that turn towards the eye have
  // fewer cracks.
  double splat_size = 1.0;
  // A splat is as wide across the line of sight as splat_size says, so wider on the plane, which an
  // eye from the side sees slanted. For parallel reliefs.
  bool splats_face_eye = false;
  // Texels of the result per texel of the source plane. Halved until the result has at most
  // max_size texels a side.
  double resolution = 1.0;
  int max_size = 1024;
  // Tiles are strips of so many texels squared at most, in the mean. Measured: 512 (2 MB) is better
  // than 384 on two threads, as fewer samples are warped twice; with 1024 a strip of 5 MB takes a
  // tenth longer where other things use the cache between frames.
  int tile_size = 512;
  // Closes pinholes between splats (fill_pinholes.h).
  bool fill_pinholes = false;
};

// What the last warp() did.
struct PrewarpStats {
  double resolution = 0;           // after halving
  int tiles = 0;                   // of the result, in view: more on more threads
  std::size_t samples_warped = 0;  // tiles overlap in the source: some samples count several times
  std::size_t samples_drawn = 0;   // samples of these that covered a texel; each counts once
};

// The pre-warp of one relief, with the memory that it needs.
class Prewarp {
 public:
  // `relief` must outlive the object.
  explicit Prewarp(const LayeredRelief& relief, const PrewarpOptions& options = {});
  ~Prewarp();
  Prewarp(Prewarp&&) noexcept;
  Prewarp& operator=(Prewarp&&) noexcept;

  // Warps the relief for `eye` (world space). What lies behind the eye, or so near to it that it
  // would be magnified more than 64 times, is left out; none if that is everything, or if the eye
  // is not in front of a parallel relief's plane. Only what is within `view`'s frustum is warped
  // (null: all).
  [[nodiscard]] std::optional<PrewarpStats> warp(const glm::dvec3& eye, const Camera* view,
                                                 Prewarped& result);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// A rectangle on the source plane, in source texels.
struct ReliefRectangle {
  glm::dvec2 min{0.0}, max{0.0};
};
// The tight rectangle that contains all samples' splats (S4.3), `splat_size` times the relief's
// scale; none if Prewarp::warp leaves some out. The hull's corners touch it on all sides.
[[nodiscard]] std::optional<ReliefRectangle> relief_rectangle(const LayeredRelief& relief,
                                                              const ReliefWarp& warp,
                                                              double splat_size = 1.0);

}  // namespace rilievo

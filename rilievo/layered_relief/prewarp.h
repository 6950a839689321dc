// What does an eye see of a layered relief, as a flat picture on the relief's source plane?
// (S4.2, S4.3, S4.5 to S4.8, S4.10)
//
// The result is a nailboard captured by the eye itself: its camera stands at the eye and looks
// straight at the source plane, its window is the rectangle there that the samples land in, its
// Deltas are their depths. Whatever draws nailboards draws it, from this eye without parallax.
//
// Result space: texels of the source plane times `resolution`; the grid stands still on the plane,
// so that its tiles can be kept while the eye moves. Tiles are warped in parallel and share
// nothing: the same bytes for any number of threads and on every instruction set.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/core/picture_geometry.h"
#include "rilievo/layered_relief/layered_relief.h"
#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

enum class Splat {
  nearest,    // the texel at the sample's centre
  rectangle,  // the texels within the sample's source texel, moved and scaled (S4.5)
};

struct PrewarpOptions {
  Splat splat = Splat::rectangle;
  // Edge of a splat in source texels. With 1 those of equal depth meet exactly, and none hides what
  // it must not; with 2, the paper's, surfaces that turn towards the eye have fewer cracks.
  double splat_size = 1.0;
  // Texels of the result per texel of the source plane. Halved as often as it takes for the result
  // to have at most max_size texels a side.
  double resolution = 1.0;
  int max_size = 1024;
  // Texels of the result. Measured: at 256, with 8 bytes a texel in the second-level cache, a sixth
  // of a deep object's samples are warped twice; at 128 nearly all.
  int tile_size = 256;
  // A tile of the last result stays if none of its samples would land farther than so many texels
  // from where they are; 0: only if they would land in the same places.
  double reuse_error = 0.0;
};

// The picture; planes in row order, `geometry.capture` has their size. As a Nailboard's, but for
// empty texels, none of which has a Delta.
struct Prewarped {
  PictureGeometry geometry;
  std::vector<glm::u8vec4> color;
  std::vector<std::uint16_t> delta;
  [[nodiscard]] int width() const { return geometry.capture.width; }
  [[nodiscard]] int height() const { return geometry.capture.height; }
};

struct PrewarpStats {
  double resolution = 0;           // after halving
  int tiles = 0, warped = 0;       // of the result that are in view; of them not reused
  std::size_t samples_warped = 0;  // tiles overlap, so some samples are warped several times ...
  std::size_t samples_drawn = 0;   // ... of these runs' samples, each once
  double largest_reuse_error = 0;  // of a tile that stayed, texels
};

class Prewarp {
 public:
  // The relief must outlive it.
  explicit Prewarp(const LayeredRelief& relief, const PrewarpOptions& options = {});
  ~Prewarp();
  Prewarp(Prewarp&&) noexcept;
  Prewarp& operator=(Prewarp&&) noexcept;

  // As seen from `eye`; nothing if part of the relief lies behind the eye's plane, or so near to it
  // that it would be magnified more than 64 times. Only tiles that `view`'s frustum meets are
  // warped; null: all. Once out_of_time() is true, tiles that have been warped before stay as they
  // are; those with the largest errors come first.
  [[nodiscard]] std::optional<PrewarpStats> warp(const glm::dvec3& eye, const Camera* view,
                                                 Prewarped& result,
                                                 const std::function<bool()>& out_of_time = {});

  // Forgets all tiles.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// The rectangle on the source plane, in source texels, that all samples' splats land in (S4.3);
// nothing as above. Without samples outside it, and touched by the hull's corners on all sides.
struct ReliefRectangle {
  glm::dvec2 min{0.0}, max{0.0};
};
[[nodiscard]] std::optional<ReliefRectangle> relief_rectangle(const LayeredRelief& relief,
                                                              const ReliefWarp& warp,
                                                              double splat_size = 1.0);

}  // namespace rilievo

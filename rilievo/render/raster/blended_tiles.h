// How do parts that blend get into a frame that processors draw?
//
// As render/opengl draws them: after everything opaque and the sky; objects back to front, their
// triangles in their order; each sample of a triangle that nothing opaque hides is blended over
// what is there, premultiplied, in bytes. Writes no depth. A pixel is shaded once for each
// triangle: at its centre, or, if not all of 4 samples show the triangle, in the middle of those
// that do. For few large triangles (windows, water): one thread lists them by tiles, all cores
// place and draw them. The result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Draws the blended parts of one scene into the tiles of a SoftwareTarget.
class BlendedTiles final : public TileDrawer {
 public:
  // `scene` must be valid and outlive the object. Makes the mip levels of its textures with the
  // first parts that blend.
  explicit BlendedTiles(const Scene& scene);
  ~BlendedTiles() override;

  // Prepares a frame of colours with 1 or 4 samples: the blended parts of `objects`. Requires a
  // perspective camera.
  void place(const Camera& camera, int samples, const PlacedScene& placed,
             std::span<const std::uint32_t> objects);
  // Does the last frame show any?
  [[nodiscard]] bool any() const;

  void draw_tile(FrameTile& tile) const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo

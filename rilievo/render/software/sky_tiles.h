// What is seen where a frame shows nothing? The scene's sky.
//
// As render/opengl draws it: two colours blended by elevation, evaluated at the pixel's centre, in
// all samples that show nothing. Colours come from a table; the error is below half of 1 / 255.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/software/frame_tile.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Draws the sky into the tiles of a SoftwareTarget. Must be the last to draw: the sky has no depth.
class SkyTiles final : public TileDrawer {
 public:
  explicit SkyTiles(const Sky& sky) { set(sky); }

  // Shows another sky from now on; costs nothing if it is the same.
  void set(const Sky& sky);
  // Prepares a frame. Requires a perspective camera.
  void place(const Camera& camera);

  void draw_tile(FrameTile& tile) const override;

  // The entries of the table on each side of the horizon.
  static constexpr int kEntries = 4096;
  // What a tile needs: colours by sqrt(|elevation|), first those above the horizon, and the
  // direction at the upper left corner of the frame and from pixel to pixel.
  struct View {
    const std::uint32_t* table;
    glm::vec3 first, per_x, per_y;
  };

 private:
  Sky sky_;
  std::vector<std::uint32_t> table_;
  glm::vec3 first_{0, 0, -1}, per_x_{0}, per_y_{0};
};

}  // namespace rilievo

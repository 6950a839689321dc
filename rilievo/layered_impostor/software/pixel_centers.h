// What do the pixels of a tile, and those beside it, show of a layered impostor at their centres?
// Internal to `layered_impostor/software`.
#pragma once

#include <utility>

#include "rilievo/layered_impostor/software/layered_rays.h"
#include "rilievo/layered_impostor/software/placed_layered.h"
#include "rilievo/layered_impostor/software/silhouette_pixels.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

class PixelCenters {
 public:
  // Looks where nothing is nearer that the tile shows already.
  void look(const LayeredRays& rays, const PlacedLayered& placed, const FrameTile& tile);
  // Looks at the pixels beside the tile, next to those asked for: a silhouette may pass along its
  // border. What is nearer there is in another tile, and is not looked for.
  void look_beside(const LayeredRays& rays, const PlacedLayered& placed, const FrameTile& tile);

  // The pixels that were looked at, and those of them that show the impostor.
  [[nodiscard]] const TileBits& asked() const { return asked_; }
  [[nodiscard]] const TileBits& shown() const { return shown_; }
  // Of a pixel of the tile that was asked for, by its block and its place in that.
  [[nodiscard]] const SeenLayered& seen(int block, int pixel) const { return seen_[block][pixel]; }
  // Where along its rays a pixel of a silhouette shows something, as it and its neighbours do.
  [[nodiscard]] std::pair<double, double> stretch(const PlacedLayered& placed, int x, int y) const;

 private:
  static constexpr int kRow = FrameTile::kBlock;
  static_assert(kRow == LayeredRays::kCount);
  void look_at_block(const LayeredRays& rays, const PlacedLayered& placed, const FrameTile& tile,
                     int block);
  [[nodiscard]] float inverse_z(int x, int y) const;

  TileBits asked_, shown_;
  SeenLayered seen_[FrameTile::kBlockCount][FrameTile::kBlockPixels];  // where asked for
  // What the pixels beside the tile show: above, below, left, right.
  float beside_[4][FrameTile::kSize];
};

}  // namespace rilievo

// How are many nailboards drawn without OpenGL, with the depth of what they show?
//
// As nailboard/gl/nailboard_drawer.h draws them: front to back, with exact, linear or flat depth;
// colours and alpha between four texels; alpha becomes coverage of 1 or 4 samples with the same
// thresholds; cross-fade ranges by the same hash of the pixel. What is empty or hidden is skipped
// by cells of the picture and blocks of the tile. Placing uses all cores; a steady frame allocates
// nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/nailboard/sample_rounding.h"
#include "rilievo/nailboard/software/compose_tile.h"
#include "rilievo/nailboard/software/software_nailboard.h"
#include "rilievo/render/software/frame_tile.h"
#include "rilievo/render/software/line_tiles.h"

namespace rilievo {

// A nailboard in memory, placed.
struct SoftwareNailboardInstance {
  const SoftwareNailboard* picture = nullptr;  // outlives the frame
  PictureGeometry geometry;
  // The rigid motion of the object since the capture.
  glm::dmat4 world_now_from_capture{1.0};
  // The object identifier to write; kNoObject: those of the picture's texels.
  std::uint32_t object = kNoObject;
  // The cross-fade range: drawn only at pixels whose hash lies in [share_from, share_to).
  float share_from = 0, share_to = 1;
};

// Adds the outlines of nailboards' polygons (S1.8) to `lines`, which it begins.
void place_outlines(const Camera& frame, std::span<const SoftwareNailboardInstance> instances,
                    LineTiles& lines);

// Draws nailboards into the tiles of a SoftwareTarget.
class NailboardComposer final : public TileDrawer {
 public:
  explicit NailboardComposer(SampleRounding rounding = SampleRounding::up) : rounding_(rounding) {}

  // Prepares a frame of `frame`'s size. Requires a perspective camera.
  void place(const Camera& frame, DepthMode mode,
             std::span<const SoftwareNailboardInstance> instances);

  void draw_tile(FrameTile& tile) const override;

  // How much of the last frame shows each instance, in their order: of the blocks of 8 x 8 pixels
  // that its rectangle meets, the share in which it was nearest when it was drawn, front to back.
  // 0: it is hidden, or not in view. Valid once the frame's tiles are drawn.
  void find_seen_shares(std::vector<float>& shares) const;

  // The pixels of the rectangles around the instances in view, of the last place().
  [[nodiscard]] std::uint64_t placed_pixels() const { return placed_pixels_; }

 private:
  SampleRounding rounding_;
  struct Key {
    double distance;
    std::uint32_t index;
  };
  std::vector<PlacedNailboard> placed_;        // by instance
  std::vector<Key> order_;                     // those in view, front to back
  std::vector<std::uint32_t> first_, listed_;  // of each tile: listed_[first_[t] ... first_[t + 1])
  // Of listed_, by tiles: the blocks drawn (compose_tile). Each tile has entries of its own.
  mutable std::vector<std::uint8_t> drawn_blocks_;
  int tiles_across_ = 0, tiles_down_ = 0;
  std::uint64_t placed_pixels_ = 0;
};

}  // namespace rilievo

// How does a warped frame get into the tiles of a SoftwareTarget?
//
// As one sample a pixel, with its depth, so that polygons before and behind it are drawn as ever.
// What it does not show is filled by rays, with all samples of the frame; or, where that is much,
// by what rays found in the frames before (hole_points.h) and one ray a pixel. Uses all cores; the
// result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/keyframes/filled_hole.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/render/rays/cast_pixels.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Draws a warped frame: itself first; and sky() after everything opaque.
class KeyframeTiles final : public TileDrawer {
 public:
  // `rays`, of the scene, fills holes, and `sky` those in which they find nothing; both must
  // outlive the object.
  KeyframeTiles(const RayScene& rays, const TileDrawer& sky);
  ~KeyframeTiles() override;

  // Allocates what frames of this size need (pixels) in which rays fill so many holes and points
  // show as many others, so that the first such frame does not wait for new pages. Call it between
  // two frames: it forgets what the last one found.
  void take_memory(int width, int height, std::size_t holes);

  // Begins a frame: finds its holes, and what the frames before tell of `objects` there, if there
  // are more than `most_fine`. Returns the number of those that rays have to tell of. `warped` must
  // live until the frame is drawn.
  std::size_t find_holes(const Camera& camera, const WarpedFrame& warped,
                         std::span<const std::uint32_t> objects, std::size_t most_fine);
  // A lower bound of what find_holes() will return for this frame, at next to no cost. Before it.
  [[nodiscard]] std::size_t least_open(const WarpedFrame& warped) const;
  // After find_holes() of this frame and the same `objects`: prepares colours with 1 or 4 samples,
  // in the light of `keyframes`.
  void place(int samples, std::span<const std::uint32_t> objects,
             std::span<const WarpedKeyframe> keyframes);
  // After the colours: prepares identifiers, `shown` of what was warped, and what `objects` show in
  // holes.
  void place_objects(const Image<std::uint32_t>& shown, std::span<const std::uint32_t> objects);

  // After place(), for who draws elsewhere: what draw_tile() and the sky show in the holes, the
  // mean of their samples. Draw either.
  void read_holes(std::vector<FilledHole>& filled) const;

  void draw_tile(FrameTile& tile) const override;
  // The sky as keyframes show it, with what was before it in part of a texel, and that of holes.
  [[nodiscard]] const TileDrawer& sky() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo

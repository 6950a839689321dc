// How do polygons get into a frame that processors draw?
//
// All of a frame's polygons are rasterised at once, with the samples of the frame, or rays find
// which one each sample shows (render/shading/frame_visibility.h). Tiles first take
// over their depths, sample by sample, so that what they hide is not drawn; and at the end, when it
// is known which samples are not hidden by something else, those are shaded. A block of which each
// pixel shows one triangle keeps a single sample a pixel. Uses all cores; the result does not
// depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/image.h"
#include "rilievo/core/result.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/render/object_work.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/shading/frame_visibility.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Draws polygons of one scene into the tiles of a SoftwareTarget: itself before, and shading()
// after everything opaque.
class PolygonTiles final : public TileDrawer {
 public:
  // `scene` must be valid and outlive the object. `visibility`, of the same scene, finds what
  // samples show; null: the rasteriser, which makes the mip levels of the scene's textures with the
  // first polygons.
  explicit PolygonTiles(const Scene& scene, std::unique_ptr<FrameVisibility> visibility = nullptr);
  ~PolygonTiles() override;

  // Prepares a frame of colours with 1 or 4 samples, of the opaque and masked parts of `objects`,
  // and of those that fade within their ranges. Does not cull. Fails where `visibility` does.
  // Requires a perspective camera.
  Result<> place(const Camera& camera, int samples, const PlacedScene& placed,
                 std::span<const std::uint32_t> objects, std::span<const CrossFade> fading);
  // Prepares a frame of their identifiers, which has one sample a pixel.
  Result<> place_objects(const Camera& camera, const PlacedScene& placed,
                         std::span<const std::uint32_t> objects, std::span<const CrossFade> fading);

  // 1 / eye_z of what they show in each pixel: of the farthest of its samples; 0 where one of them
  // shows nothing. `cover` gets the frame's size.
  void find_cover(const Camera& camera, Image<float>& cover) const;

  // What drawing the objects of the last frame of colours took, one entry each, front to back,
  // those that fade last. The same for any number of threads. Valid after the frame is drawn, until
  // the next place().
  [[nodiscard]] std::span<const ObjectWork> work();

  // Depths, or identifiers.
  void draw_tile(FrameTile& tile) const override;
  // Colours, of what is still seen of the same tile.
  [[nodiscard]] const TileDrawer& shading() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo

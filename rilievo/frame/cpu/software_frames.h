// In which order is a frame drawn without OpenGL? As with it (frame/gl/scene_frames.h).
//
// Polygons' depths come first here: they hide parts of pictures, which then cost nothing; and their
// colours last: what pictures hide of them is not shaded. Opaque parts and
// the sky are drawn; parts that blend, and outlines, are not. Into a target of the source's own,
// of the camera's size. Uses all cores; the frame does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/frame/frame_source.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/polygon_tiles.h"
#include "rilievo/render/software/sky_tiles.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// A frame source that draws without OpenGL. Derived classes choose what each object is drawn from.
class SoftwareFrames : public FrameSource {
 public:
  // Can all of the scene be drawn? Not if parts of it blend.
  [[nodiscard]] static bool draws_all_of(const Scene& scene);

  // `scene` must be valid and outlive the source. `samples` of a pixel: 1 or 4.
  SoftwareFrames(const Scene& scene, int samples);

  // See FrameSource. Fail where a capture or the rasteriser does.
  Result<> draw(const Camera& camera, double time) final;
  Result<> draw_objects() final;
  [[nodiscard]] const SoftwareTarget* software_target() const final { return &target_; }
  [[nodiscard]] const FrameStats& stats() const final { return stats_; }
  void append_errors(int step, std::vector<float>& errors_px) const final;

 protected:
  // As SceneFrames::choose().
  virtual Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) = 0;
  // Called before identifiers are drawn: captures those that are missing.
  virtual void prepare_objects() {}

  [[nodiscard]] const PlacedScene& placed() const { return placed_; }
  [[nodiscard]] FrameContent& content() { return content_; }
  [[nodiscard]] const FrameContent& content() const { return content_; }
  // The drawers of content().sets, one for each, in their order; they draw what the set's drawable
  // has placed. Fills both once.
  [[nodiscard]] std::vector<const TileDrawer*>& set_drawers() { return set_drawers_; }

  bool sky_ = true;  // draw the scene's sky behind everything

 private:
  void place_sets(Output output);

  PlacedScene placed_;
  int samples_;
  SoftwareTarget target_;
  PolygonTiles polygons_;
  SkyTiles sky_tiles_;
  FrameContent content_;
  FrameStats stats_;
  std::vector<const TileDrawer*> set_drawers_, drawers_;
  Camera camera_;
};

// Draws every object as polygons, by the rasteriser.
class SoftwareDirectFrames final : public SoftwareFrames {
 public:
  using SoftwareFrames::SoftwareFrames;

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
};

}  // namespace rilievo

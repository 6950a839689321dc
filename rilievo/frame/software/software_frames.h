// In which order is a frame drawn without OpenGL? As with it (frame/gl/scene_frames.h).
//
// Polygons' depths come first here: they hide parts of pictures, which then cost nothing; and their
// colours after that: what pictures hide of them is not shaded. Then the sky, what blends, and
// outlines. Into a target of the source's own, of the camera's size. Uses all cores; the frame does
// not depend on the number of threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/frame/frame_source.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/blended_tiles.h"
#include "rilievo/render/raster/polygon_tiles.h"
#include "rilievo/render/software/sky_tiles.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/bend.h"

namespace rilievo {

// A frame source that draws without OpenGL. Derived classes choose what each object is drawn from.
class SoftwareFrames : public FrameSource {
 public:
  // `scene` must be valid and outlive the source. `samples` of a pixel: 1 or 4. `deformations`,
  // if there are any, bend a copy of the scene to each frame's time, and must outlive the source.
  SoftwareFrames(const Scene& scene, int samples, const Deformations* deformations = nullptr);
  // `visibility` finds the polygons instead of the rasteriser.
  SoftwareFrames(const Scene& scene, int samples, std::unique_ptr<FrameVisibility> visibility);

  // See FrameSource. Fail where a capture or the search for polygons does.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() final;
  [[nodiscard]] const SoftwareTarget* software_target() const final { return &target_; }
  [[nodiscard]] const FrameStats& stats() const final { return stats_; }

 protected:
  // As SceneFrames::choose().
  virtual Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) = 0;
  // Called after each frame of colours, with what drawing its polygons took.
  virtual void learn(std::span<const ObjectWork> /*work*/) {}
  // Called before identifiers are drawn: captures those that are missing.
  virtual void prepare_objects() {}
  // As SceneFrames'.
  [[nodiscard]] virtual bool shows_blended(std::uint32_t /*object*/) const { return false; }

  [[nodiscard]] const PlacedScene& placed() const { return placed_; }
  [[nodiscard]] FrameContent& content() { return content_; }
  [[nodiscard]] const FrameContent& content() const { return content_; }
  bool outlines_ = false;  // draw outlines around pictures (S1.8)
  bool sky_ = true;        // draw the scene's sky behind everything

 private:
  SoftwareFrames(const Scene& scene, int samples, const Deformations* deformations,
                 std::unique_ptr<FrameVisibility> visibility);
  void place_sets(Output output);
  void place_blended();
  void place_outlines();

  const Deformations* deformations_;
  std::unique_ptr<Scene> bent_;  // null: nothing bends
  double bent_to_ = NAN;
  PlacedScene placed_;
  int samples_;
  SoftwareTarget target_;
  PolygonTiles polygons_;
  SkyTiles sky_tiles_;
  BlendedTiles blended_tiles_;
  bool blends_ = false;                         // does any part of the scene?
  std::vector<std::uint32_t> blended_in_view_;  // objects
  FrameContent content_;
  FrameStats stats_;
  std::vector<const TileDrawer*> drawers_;
  Camera camera_;
};

// Draws every object as polygons, by the rasteriser or another FrameVisibility: the true frame, and
// the baseline.
class SoftwareDirectFrames final : public SoftwareFrames {
 public:
  using SoftwareFrames::SoftwareFrames;

 private:
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
};

}  // namespace rilievo

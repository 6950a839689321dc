// The order of a frame that is drawn without OpenGL; frame/gl/opengl_frames.h has the same with it.
//
// Polygons' depths come first here: they hide parts of pictures, which then cost nothing; and their
// colours after that: what pictures hide of them is not shaded. Then the sky, what blends, and
// outlines. Into a target of the source's own, of the camera's size. Uses all cores; the frame does
// not depend on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/frame/frame_chooser.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/render/raster/blended_tiles.h"
#include "rilievo/render/raster/polygon_tiles.h"
#include "rilievo/render/software/sky_tiles.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// Draws what a chooser chooses, without OpenGL.
class SoftwareFrames final : public FrameSource {
 public:
  // `backend` must outlive the source, unless `chooser`, of its scene, keeps it. `visibility` finds
  // the polygons instead of the rasteriser.
  SoftwareFrames(SoftwareBackend& backend, std::unique_ptr<FrameChooser> chooser,
                 std::unique_ptr<FrameVisibility> visibility = nullptr);

  // See FrameSource. Fail where the choice or the search for polygons does.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] const SoftwareTarget* software_target() const override { return &target_; }
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return chooser_->read_pictures(content_);
  }

 private:
  Result<> draw_chosen();
  void place_sets(Output output);
  void place_blended();
  void place_outlines();

  std::unique_ptr<FrameChooser> chooser_;  // outlives what is drawn from its scene
  SoftwareBackend& backend_;
  const PlacedScene& placed_;
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
  double time_ = 0;
};

}  // namespace rilievo

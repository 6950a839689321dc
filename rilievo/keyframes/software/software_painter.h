// Warps keyframes and draws frames on processors, into a target in memory.
#pragma once

#include <memory>
#include <vector>

#include "rilievo/keyframes/keyframe_painter.h"
#include "rilievo/render/raster/blended_tiles.h"
#include "rilievo/render/raster/polygon_tiles.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {

// The painter without OpenGL. Uses all cores; the result does not depend on their number.
class SoftwarePainter final : public KeyframePainter {
 public:
  // `scene` must outlive the painter; 1 or 4 samples of a pixel. `visibility`: as PolygonTiles'.
  SoftwarePainter(const Scene& scene, int samples, std::unique_ptr<FrameVisibility> visibility);

  void begin(const Camera& camera, const PlacedScene& placed, double time) override;
  Result<> place(std::span<const std::uint32_t> polygons) override;
  Result<> warp(std::span<const WarpedKeyframe> keyframes, float nearest, bool leaves_sky,
                WarpedFrame& out) override;
  Result<> draw(const KeyframeContent& content) override;
  Result<> draw_objects(KeyframeTiles* warped) override;
  void take_memory(std::span<const std::uint32_t> polygons) override;
  [[nodiscard]] double polygon_share(const WarpedFrame& warped) const override;
  [[nodiscard]] const SoftwareTarget* target() const override { return &target_; }

 private:
  int samples_;
  Camera camera_;
  const PlacedScene* placed_ = nullptr;
  std::span<const std::uint32_t> live_;
  SoftwareTarget target_;
  PolygonTiles polygons_;
  BlendedTiles blended_;
  Image<float> cover_;  // of polygons
  std::vector<const TileDrawer*> drawers_;
};

}  // namespace rilievo

// The library's own rasteriser as a source of pictures, without OpenGL.
//
// Captures a scene as it is placed now. Perspective cameras, any objects, wherever they are. The
// same surfaces, depths, identifiers and shading as OpenGL's; blended parts are absent. On
// processors several times as fast as OpenGL there. Uses all cores; the result does not depend on
// the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// A scene in the rasteriser as a capture source.
class RasterSource final : public CaptureSource {
 public:
  // `placed` must outlive the source.
  explicit RasterSource(const PlacedScene& placed) : placed_(placed), rasterizer_(placed.scene()) {}

  [[nodiscard]] std::string_view name() const override { return placed_.scene().name; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Fails for an invalid camera, or one that is not perspective or larger than
  // SampleRaster::kMaxSize, for other numbers of samples than 1 and 4, and for `farthest` of
  // objects that reach beyond the far plane.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  // Object after object, near ones first, then row after row. Poses are those of begin().
  [[nodiscard]] std::unique_ptr<PictureInParts> in_parts() override;
  // The scene's materials, which others may share.
  [[nodiscard]] const std::shared_ptr<const SurfaceMaterials>& materials() const {
    return rasterizer_.materials();
  }
  [[nodiscard]] const Scene* scene() const override { return &placed_.scene(); }

 private:
  const PlacedScene& placed_;
  PictureRasterizer rasterizer_;
  std::vector<std::uint32_t> visible_;
};

}  // namespace rilievo

// The library's own rasteriser, and rays for the pictures that it cannot take: those of other
// cameras than perspective ones, and layers. The same surfaces, depths and shading. One thread at a
// time.
#pragma once

#include "rilievo/capture/raster_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/render/raster/sample_raster.h"

namespace rilievo {

// A scene without OpenGL.
class RasterRaySource final : public CaptureSource {
 public:
  // Both must outlive it, and be of the same scene at the same time.
  RasterRaySource(const PlacedScene& placed, const RayScene& rays) : raster_(placed), rays_(rays) {}

  [[nodiscard]] std::string_view name() const override { return raster_.name(); }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override {
    return raster_.bounds(objects);
  }
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    const Camera& camera = request.camera;
    const bool fits = camera.projection == Projection::perspective &&
                      std::max(camera.width, camera.height) <= SampleRaster::kMaxSize;
    return fits ? raster_.capture(request) : rays_.capture(request);
  }
  [[nodiscard]] std::unique_ptr<PictureInParts> in_parts() override { return raster_.in_parts(); }
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override {
    return rays_.capture_layers(request);
  }
  [[nodiscard]] const Scene* scene() const override { return raster_.scene(); }

 private:
  RasterSource raster_;
  RaySource rays_;
};

}  // namespace rilievo

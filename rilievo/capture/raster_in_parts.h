// Pictures by the library's rasteriser, in parts. Internal to capture.
#pragma once

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/picture_parts.h"

namespace rilievo {

// Fails where the rasteriser cannot capture this; `name`: of the source.
[[nodiscard]] Result<> can_rasterize(const CaptureRequest& request, std::string_view name);

// Rasterises object after object, near ones first, then shades rows.
class RasterInParts final : public PictureInParts {
 public:
  // `placed` must outlive it.
  RasterInParts(const PlacedScene& placed, std::shared_ptr<const SurfaceMaterials> materials)
      : placed_(placed), parts_(placed.scene(), std::move(materials)) {}

  // Requires one sample a texel.
  Result<> begin(const CaptureRequest& request) override;
  int advance(double share) override { return parts_.advance(share); }
  void read(int from, int to, DepthImage& picture) override;

 private:
  const PlacedScene& placed_;
  PictureParts parts_;
  bool with_sky_ = false, identifiers_ = true;
  std::vector<std::uint32_t> visible_;
};

}  // namespace rilievo

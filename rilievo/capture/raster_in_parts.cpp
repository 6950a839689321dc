#include "rilievo/capture/raster_in_parts.h"

#include <algorithm>
#include <string>

#include "rilievo/capture/placed_raster.h"
#include "rilievo/core/expects.h"

namespace rilievo {

Result<> can_rasterize(const CaptureRequest& request, std::string_view name) {
  const Camera& camera = request.camera;
  if (Result<> valid = validate(camera); !valid) return valid.error();
  const auto refuse = [&](const std::string& why) { return Error{std::string(name), why}; };
  if (camera.projection != Projection::perspective)
    return refuse("the rasteriser captures with perspective cameras only");
  if (std::max(camera.width, camera.height) > SampleRaster::kMaxSize)
    return refuse("the rasteriser captures at most " + std::to_string(SampleRaster::kMaxSize) +
                  " texels a side");
  if (!PlacedRaster::can_sample(request.samples))
    return refuse("the rasteriser captures 1 or 4 samples per texel");
  return Done{};
}

Result<> RasterInParts::begin(const CaptureRequest& request) {
  if (Result<> can = can_rasterize(request, placed_.scene().name); !can) return can.error();
  RILIEVO_EXPECTS(request.samples == 1);
  const Camera& camera = request.camera;
  with_sky_ = request.with_sky, identifiers_ = request.identifiers;
  visible_.clear();
  if (request.objects.empty())
    placed_.cull(camera, visible_);
  else
    placed_.cull(camera, request.objects, visible_);
  parts_.begin(camera, placed_, visible_, request.staggered);
  return Done{};
}

void RasterInParts::read(int from, int to, DepthImage& picture) {
  parts_.read(from, to, with_sky_, picture);
  if (!identifiers_) picture.object = {};
}

}  // namespace rilievo

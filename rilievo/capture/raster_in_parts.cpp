#include "rilievo/capture/raster_in_parts.h"

#include <algorithm>
#include <string>

#include "rilievo/capture/placed_raster.h"
#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// To shade a texel takes as long as to rasterise so many triangles, about: of big scenes, most of
// which is hidden or smaller than texels.
constexpr double kTexel = 4;

}  // namespace

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
  camera_ = request.camera;
  with_sky_ = request.with_sky, identifiers_ = request.identifiers;
  visible_.clear();
  if (request.objects.empty())
    placed_.cull(camera_, visible_);
  else
    placed_.cull(camera_, request.objects, visible_);
  // What is near hides most of the rest.
  nearest_first_.clear();
  for (const std::uint32_t object : visible_)
    nearest_first_.emplace_back(
        glm::length(glm::dvec3(placed_.bounds()[object].center()) - camera_.position()), object);
  std::ranges::sort(nearest_first_);
  visible_.clear();
  for (const auto& [distance, object] : nearest_first_) visible_.push_back(object);
  raster_.place(camera_, visible_, placed_.poses());
  raster_.begin(camera_, 1, NearPlane::cuts);
  left_to_find_ = double(raster_.triangles());
  work_ = left_to_find_ + kTexel * camera_.width * camera_.height;
  found_ = false, rows_ = 0;
  return Done{};
}

int RasterInParts::advance(double share) {
  double work = std::max(share, 0.0) * work_;
  if (!found_) {
    found_ = !raster_.fill_some(std::uint64_t(work) + 1);
    if (!found_) {
      left_to_find_ -= std::min(work, left_to_find_);
      return 0;
    }
    work = std::max(work - left_to_find_, 0.0);
  }
  rows_ = std::min(rows_ + work / (kTexel * camera_.width), double(camera_.height));
  return int(rows_);
}

DepthImage RasterInParts::read(int from, int to) {
  RILIEVO_EXPECTS(found_ && 0 <= from && from < to && to <= camera_.height);
  const int first = camera_.height - to;  // rows of the samples are from the bottom
  DepthImage picture;
  picture.camera = camera_;
  const double per_row = (camera_.window.top - camera_.window.bottom) / camera_.height;
  picture.camera.window.top = camera_.window.top - from * per_row;
  picture.camera.window.bottom = camera_.window.top - to * per_row;
  picture.camera.height = to - from;
  identify(raster_.seen(), raster_.meshes(), first, picture);
  PictureView view = raster_.view(camera_);
  view.scene.scale = ColorScale::linear;
  shader_.shade(view, picture, with_sky_, first);
  if (!identifiers_) picture.object = {};
  return picture;
}

}  // namespace rilievo

#include "rilievo/render/raster/picture_parts.h"

#include <algorithm>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// To shade a texel takes as long as to rasterise so many triangles, about: of big scenes, most of
// which is hidden or smaller than texels.
constexpr double kTexel = 4;

}  // namespace

void PictureParts::begin(const Camera& camera, const PlacedScene& placed,
                         std::span<const std::uint32_t> objects, bool staggered) {
  camera_ = camera;
  raster_.place_nearest_first(camera_, placed, objects);
  raster_.begin(camera_, 1, NearPlane::cuts, staggered);
  left_to_find_ = double(raster_.triangles());
  work_ = left_to_find_ + kTexel * camera_.width * camera_.height;
  found_ = false, rows_ = 0;
}

int PictureParts::advance(double share) {
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

void PictureParts::read(int from, int to, bool with_sky, DepthImage& picture) {
  RILIEVO_EXPECTS(found_ && 0 <= from && from < to && to <= camera_.height);
  const int first = camera_.height - to;  // rows of the samples are from the bottom
  picture.camera = camera_of_part(camera_, 0, from, camera_.width, to - from);
  identify(raster_.seen(), raster_.meshes(), first, picture);
  PictureView view = raster_.view(camera_);
  view.scene.scale = ColorScale::linear;
  shader_.shade(view, picture, with_sky, first);
}

}  // namespace rilievo

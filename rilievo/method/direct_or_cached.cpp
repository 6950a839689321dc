#include "rilievo/method/direct_or_cached.h"

#include <utility>

namespace rilievo {
namespace {

// A triangle of CostModel, ms, on the machine of FrameLoad: fitted to frames of the cache.
constexpr double kCountedTriangleMs = 35e-6;
// A pixel of a frame, whatever it shows, in triangles.
constexpr double kFramePixel = 0.06;
// The pixels of a picture, in the mean.
constexpr double kPicturePixels = 64 * 64;

// Pictures and captures, in triangles.
double beside_polygons(const FrameContent& content, const FrameStats& stats) {
  const CostModel cost;
  double triangles = 0;
  for (const FrameContent::Set& set : content.sets)
    triangles +=
        double(set.instances.size()) * (cost.picture + kPicturePixels * cost.picture_pixel);
  return triangles + stats.captures * (40 + kPicturePixels * cost.capture_texel);
}

}  // namespace

Result<> DirectOrCached::choose(const Camera& camera, const PlacedScene& placed,
                                FrameContent& content, FrameStats& stats) {
  if (uses_cache_ && !cache_ && !failed_) {
    Result<std::unique_ptr<SceneCache>> made = SceneCache::create(backend_, options_);
    failed_ = !made;
    if (made) {
      cache_ = std::move(*made);
      cache_->add_sets(content);
    }
  }
  Result<> chosen = chose_cache() ? cache_->choose(camera, placed, content, stats)
                                  : direct_.choose(camera, placed, content, stats);
  counted_ms_ = 0;
  beside_polygons_ = beside_polygons(content, stats) + kFramePixel * camera.width * camera.height;
  // OpenGL does not count what it draws.
  for (const std::uint32_t object : content.polygons)
    counted_ms_ +=
        double(placed.scene().models[std::size_t(placed.scene().objects[object].model)].triangles);
  counted_ms_ = kCountedTriangleMs * (counted_ms_ + beside_polygons_);
  return chosen;
}

void DirectOrCached::drawn(const FrameWork* work, FrameStats& stats) {
  if (chose_cache()) cache_->drawn(work, stats);
  if (!work) return;
  const CostModel cost;
  double triangles = beside_polygons_;
  for (const ObjectWork& one : work->polygons)
    triangles += cost.object + cost.projected_triangle * double(one.projected) +
                 cost.filled_triangle * double(one.filled) + cost.shaded_pixel * double(one.shaded);
  counted_ms_ = kCountedTriangleMs * triangles;
}

void DirectOrCached::prepare_objects() {
  if (chose_cache()) cache_->prepare_objects();
}

std::vector<DepthImage> DirectOrCached::read_pictures(const FrameContent& content) const {
  return chose_cache() ? cache_->read_pictures(content) : std::vector<DepthImage>();
}

}  // namespace rilievo

#include "rilievo/keyframes/software/software_painter.h"

#include <atomic>
#include <utility>

#include "rilievo/core/parallel_for.h"
#include "rilievo/keyframes/software/keyframe_tiles.h"
#include "rilievo/render/software/sky_tiles.h"

namespace rilievo {

SoftwarePainter::SoftwarePainter(const Scene& scene, int samples,
                                 std::unique_ptr<FrameVisibility> visibility)
    : samples_(samples),
      target_(1, 1, samples),
      polygons_(scene, std::move(visibility)),
      blended_(scene) {}

void SoftwarePainter::begin(const Camera& camera, const PlacedScene& placed, double /*time*/) {
  camera_ = camera;
  placed_ = &placed;
  live_ = {};
  if (target_.width() != camera.width || target_.height() != camera.height)
    target_ = SoftwareTarget(camera.width, camera.height, samples_);
}

Result<> SoftwarePainter::place(std::span<const std::uint32_t> polygons) {
  live_ = polygons;
  return polygons_.place(camera_, samples_, *placed_, polygons, {});
}

// What polygons cover is not warped.
Result<> SoftwarePainter::warp(std::span<const WarpedKeyframe> keyframes, float nearest,
                               bool leaves_sky, WarpedFrame& out) {
  const WarpCover covers{&cover_, nearest};
  if (!live_.empty()) polygons_.find_cover(camera_, cover_);
  warp_keyframes(keyframes, camera_, out, live_.empty() ? nullptr : &covers, leaves_sky);
  return Done{};
}

Result<> SoftwarePainter::draw(const KeyframeContent& content) {
  drawers_.clear();
  if (content.warped) drawers_.push_back(content.warped);
  if (!live_.empty()) drawers_.insert(drawers_.end(), {&polygons_, &polygons_.shading()});
  drawers_.push_back(content.warped ? &content.warped->sky() : content.sky);
  if (!content.blended.empty()) {
    blended_.place(camera_, samples_, *placed_, content.blended);
    if (blended_.any()) drawers_.push_back(&blended_);
  }
  target_.draw(camera_.z_far, drawers_);
  return Done{};
}

Result<> SoftwarePainter::draw_objects(KeyframeTiles* warped) {
  drawers_.clear();
  if (warped) drawers_.push_back(warped);
  if (Result<> done = polygons_.place_objects(camera_, *placed_, live_, {}); !done) return done;
  if (!live_.empty()) drawers_.push_back(&polygons_);
  target_.draw_objects(camera_.z_far, drawers_);
  return Done{};
}

void SoftwarePainter::take_memory(std::span<const std::uint32_t> polygons) {
  // A frame that is too large for polygons may need none.
  if (!polygons.empty() && place(polygons)) polygons_.find_cover(camera_, cover_);
}

double SoftwarePainter::polygon_share(const WarpedFrame& warped) const {
  if (live_.empty()) return 0;
  std::atomic<std::size_t> live = 0;
  const float nothing = float(1 / camera_.z_far);
  parallel_for(0, target_.height(), [&](int y) {
    // So written that a compiler makes vectors of it.
    const float *shown = target_.inverse_z().row(y).data(),
                *behind = warped.inverse_z.row(y).data();
    const std::uint32_t* color = warped.color.row(y).data();
    std::uint32_t in_row = 0;
    for (int x = 0; x < target_.width(); ++x)
      in_row += std::uint32_t(color[x] != 0) & std::uint32_t(shown[x] > behind[x]) &
                std::uint32_t(shown[x] > nothing);
    live += in_row;
  });
  return double(live) / (double(target_.width()) * target_.height());
}

}  // namespace rilievo

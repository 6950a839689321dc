#include "rilievo/keyframes/gl/opengl_painter.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "rilievo/core/parallel_for.h"
#include "rilievo/gl/context.h"
#include "rilievo/gl/state_guard.h"
#include "rilievo/keyframes/software/keyframe_tiles.h"

namespace rilievo {

Result<std::unique_ptr<KeyframePainter>> OpenGLPainter::create(SceneRenderer& renderer,
                                                               int samples) {
  Result<KeyframeWarper> warper = KeyframeWarper::create();
  if (!warper) return warper.error();
  return {
      std::unique_ptr<KeyframePainter>(new OpenGLPainter(renderer, samples, std::move(*warper)))};
}

void OpenGLPainter::begin(const Camera& camera, const PlacedScene& /*placed*/, double time) {
  camera_ = camera;
  time_ = time;
  live_ = {};
}

Result<> OpenGLPainter::place(std::span<const std::uint32_t> polygons) {
  live_ = polygons;
  return Done{};
}

Result<> OpenGLPainter::make_cover() {
  if (cover_ && cover_->width() == camera_.width && cover_->height() == camera_.height)
    return Done{};
  cover_.reset();
  Result<CoverTarget> made = CoverTarget::create(camera_.width, camera_.height, samples_);
  if (!made) return made.error();
  cover_.emplace(std::move(*made));
  return Done{};
}

// What polygons cover is not warped, and no ray is cast there.
Result<> OpenGLPainter::warp(std::span<const WarpedKeyframe> keyframes, float nearest,
                             bool leaves_sky, WarpedFrame& out) {
  const gl::StateGuard guard;
  if (live_.empty()) return warper_.warp(keyframes, camera_, nullptr, leaves_sky, out);
  if (Result<> done = make_cover(); !done) return done;
  renderer_.set_time(time_);
  cover_->begin();
  renderer_.draw_objects(camera_, live_);
  const WarpCoverTexture cover{cover_->depth(), cover_->samples(), nearest};
  return warper_.warp(keyframes, camera_, &cover, leaves_sky, out);
}

Result<> OpenGLPainter::draw(const KeyframeContent& content) {
  const gl::StateGuard guard;
  if (content.warped) {
    content.warped->read_holes(filled_);
    warper_.fill(filled_);
  }
  renderer_.set_time(time_);
  guard.bind_frame();
  if (content.warped) warper_.show(camera_);
  renderer_.draw_opaque(camera_, live_, OutputEncoding::srgb);
  renderer_.draw_sky(camera_, OutputEncoding::srgb);
  if (content.warped) warper_.show_sky(camera_);
  renderer_.draw_blended(camera_, content.blended, OutputEncoding::srgb);
  return Done{};
}

Result<> OpenGLPainter::draw_objects(KeyframeTiles* warped) {
  const gl::StateGuard guard;
  renderer_.set_time(time_);
  guard.bind_frame();
  if (warped) {
    if (!objects_ || objects_->width() != camera_.width || objects_->height() != camera_.height)
      objects_.emplace(camera_.width, camera_.height, 1);
    const TileDrawer* const drawers[] = {warped};
    objects_->draw_objects(camera_.z_far, drawers);
    warper_.show_objects(camera_, objects_->objects(), objects_->inverse_z());
  }
  renderer_.draw_objects(camera_, live_);
  return Done{};
}

void OpenGLPainter::finish() { gl::finish(); }

void OpenGLPainter::take_memory(std::span<const std::uint32_t> polygons) {
  const gl::StateGuard guard;
  // A frame that is too large fails when it is drawn.
  (void)warper_.resize(camera_.width, camera_.height);
  if (!polygons.empty()) (void)make_cover();
}

double OpenGLPainter::polygon_share(const WarpedFrame& warped) const {
  if (live_.empty()) return 0;
  std::atomic<std::size_t> covered = 0;
  parallel_for(0, warped.color.height(), [&](int y) {
    covered += std::size_t(std::ranges::count(warped.color.row(y), kCoveredPixel));
  });
  return double(covered) / double(warped.color.texels().size());
}

}  // namespace rilievo

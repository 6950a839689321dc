#include "rilievo/method/frame_fade.h"

#include <algorithm>
#include <cstdint>

#include "rilievo/core/box_view.h"
#include "rilievo/core/expects.h"
#include "rilievo/render/draw_list.h"

namespace rilievo {
namespace {

const std::uint32_t* words(const Rgba8Image& image) {
  return reinterpret_cast<const std::uint32_t*>(image.texels().data());
}

// What has moved within a box, for a frame of `camera` whose eye is `way` metres from that of
// `old`. The old frame is looked up by the new one's depths, so that what was before them, by no
// more than what counts as the same surface, is aside by a part of the eye's way.
MovedThing moved_within(const Box& box, const Camera& camera, const Camera& old, double way) {
  const BoxView view = view_of_box(eye_from_world(camera), box, camera.projection),
                old_view = view_of_box(eye_from_world(old), box, old.projection);
  const RasterRect rect = rect_of_box(camera, view);
  const double farthest = std::max(view.farthest, old_view.farthest),
               nearest = std::max(std::min(view.nearest, old_view.nearest), camera.z_near);
  // Not in view of either eye.
  if (farthest < nearest ||
      !(may_touch(frustum_of(camera), box) || may_touch(frustum_of(old), box)))
    return {};
  const double pixels = camera.width / (camera.window.right - camera.window.left),
               around = 1 + double(kSameSurface) * pixels *
                                std::min(way / nearest, double(kOtherShading));
  return {float(rect.left - around),   float(rect.top - around), float(rect.right + around),
          float(rect.bottom + around), float(1 / farthest),      float(1 / nearest)};
}

}  // namespace

void FrameFade::reserve(int width, int height) {
  old_ = Rgba8Image(width, height);
  old_inverse_z_ = Image<float>(width, height);
  target_ = SoftwareTarget(width, height, 1);
}

void FrameFade::begin(const SoftwareTarget& shown, const Camera& camera, int frames,
                      bool to_the_end) {
  RILIEVO_EXPECTS(frames > 0);
  old_ = shown.color();
  old_inverse_z_ = shown.inverse_z();
  old_camera_ = camera;
  of_ = left_ = frames, to_the_end_ = to_the_end;
}

void FrameFade::mix(const SoftwareTarget& frame, const Camera& camera, std::span<const Box> moved) {
  RILIEVO_EXPECTS(left_ > 0);
  RILIEVO_EXPECTS(frame.width() == old_.width() && frame.height() == old_.height());
  camera_ = camera;
  frame_ = &frame;
  frames_.color = words(frame.color()), frames_.old_color = words(old_);
  frames_.inverse_z = frame.inverse_z().texels().data();
  frames_.old_inverse_z = old_inverse_z_.texels().data();
  frames_.width = frame.width(), frames_.height = frame.height();
  frames_.old_weight = std::uint32_t(256 * left_ / (of_ + 1));
  --left_;
  if (target_.width() != frame.width() || target_.height() != frame.height())
    target_ = SoftwareTarget(frame.width(), frame.height(), 1);
  // A point of the new frame at distance 1: affine in its raster place.
  const ImageWindow& window = camera.window;
  const double across = (window.right - window.left) / camera.width,
               down = (window.bottom - window.top) / camera.height;
  const glm::dmat4 old_from_eye = eye_from_world(old_camera_) * camera.world_from_eye;
  const glm::dmat3 turn(old_from_eye);
  frames_.axis =
      glm::mat3(turn * glm::dmat3({across, 0, 0}, {0, down, 0},
                                  {window.left + across / 2, window.top + down / 2, -1}));
  frames_.step = glm::vec3(old_from_eye[3]);
  frames_.way = glm::length(frames_.step);
  const ImageWindow& old = old_camera_.window;
  frames_.to_raster = {float(old_camera_.width / (old.right - old.left)),
                       float(old_camera_.height / (old.bottom - old.top))};
  frames_.raster_start = {float(old.left), float(old.top)};
  moved_.clear();
  for (const Box& box : moved)
    moved_.push_back(moved_within(box, camera, old_camera_, double(frames_.way)));
  frames_.moved = moved_;
  most_ = 0;
  const TileDrawer* drawer = this;
  target_.draw(camera.z_far, {&drawer, 1});
  if (most_ < kUnseen && !to_the_end_) left_ = 0;
}

void FrameFade::draw_objects() {
  RILIEVO_EXPECTS(frame_ != nullptr);
  const TileDrawer* drawer = this;
  target_.draw_objects(camera_.z_far, {&drawer, 1});
}

void FrameFade::draw_tile(FrameTile& tile) const {
  const double levels = fade_tile(frames_, tile);
  for (double most = most_; levels > most && !most_.compare_exchange_weak(most, levels);) {
  }
  std::fill_n(tile.changed, FrameTile::kBlockCount, true);
  if (tile.of == TileContent::color) return;
  const int x_end = std::min(tile.x + FrameTile::kSize, tile.width),
            y_end = std::min(tile.y + FrameTile::kSize, tile.height);
  for (int y = tile.y; y < y_end; ++y)
    for (int x = tile.x; x < x_end; ++x) {
      const TilePixel at(tile, x, y);
      tile.first[at.block].content[at.pixel] = frame_->objects()(x, y);
    }
}

}  // namespace rilievo

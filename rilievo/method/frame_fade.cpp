#include "rilievo/method/frame_fade.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Surfaces are the same, or as leaves of one tree, where their distances from the old eye differ by
// at most this share.
constexpr float kSameSurface = 0.15f;

// Each byte of a and b, b with so many shares of 256.
std::uint32_t mix_bytes(std::uint32_t a, std::uint32_t b, std::uint32_t of_b) {
  constexpr std::uint32_t kEven = 0x00FF00FF, kHalf = 0x00800080;
  const std::uint32_t of_a = 256 - of_b;
  const std::uint32_t even = ((a & kEven) * of_a + (b & kEven) * of_b + kHalf) >> 8 & kEven;
  const std::uint32_t odd = ((a >> 8 & kEven) * of_a + (b >> 8 & kEven) * of_b + kHalf) & ~kEven;
  return even | odd;
}

}  // namespace

void FrameFade::begin(const SoftwareTarget& shown, const Camera& camera) {
  old_ = shown.color();
  old_inverse_z_ = shown.inverse_z();
  old_camera_ = camera;
  left_ = kFrames;
}

void FrameFade::mix(const SoftwareTarget& frame, const Camera& camera) {
  RILIEVO_EXPECTS(left_ > 0);
  RILIEVO_EXPECTS(frame.width() == old_.width() && frame.height() == old_.height());
  camera_ = camera;
  frame_ = &frame;
  weight_ = std::uint32_t(256 * left_ / (kFrames + 1));
  --left_;
  if (target_.width() != frame.width() || target_.height() != frame.height())
    target_ = SoftwareTarget(frame.width(), frame.height(), 1);
  // A point of the new frame at distance 1: affine in its raster place.
  const ImageWindow& window = camera.window;
  const double across = (window.right - window.left) / camera.width,
               down = (window.bottom - window.top) / camera.height;
  const glm::dmat4 old_from_eye = eye_from_world(old_camera_) * camera.world_from_eye;
  const glm::dmat3 turn(old_from_eye);
  axis_ = glm::mat3(turn * glm::dmat3({across, 0, 0}, {0, down, 0},
                                      {window.left + across / 2, window.top + down / 2, -1}));
  step_ = glm::vec3(old_from_eye[3]);
  const ImageWindow& old = old_camera_.window;
  to_raster_ = {float(old_camera_.width / (old.right - old.left)),
                float(old_camera_.height / (old.bottom - old.top))};
  raster_start_ = {float(old.left), float(old.top)};
  const TileDrawer* drawer = this;
  target_.draw(camera.z_far, {&drawer, 1});
}

void FrameFade::draw_objects() {
  RILIEVO_EXPECTS(frame_ != nullptr);
  const TileDrawer* drawer = this;
  target_.draw_objects(camera_.z_far, {&drawer, 1});
}

// The colour of a pixel of the new frame, mixed with what the old frame shows of it: the mean of
// the nearest texels, if the nearest one shows the same surface.
std::uint32_t FrameFade::mixed(int x, int y) const {
  const auto only_new = std::bit_cast<std::uint32_t>(frame_->color()(x, y));
  const float w = frame_->inverse_z()(x, y);
  const glm::vec3 at = axis_ * glm::vec3(float(x), float(y), 1) + w * step_;
  if (!(at.z < 0)) return only_new;
  const float near_by = 1 / -at.z, expected = w * near_by;
  const float px = (at.x * near_by - raster_start_.x) * to_raster_.x - 0.5f,
              py = (at.y * near_by - raster_start_.y) * to_raster_.y - 0.5f;
  if (!(px >= 0 && py >= 0 && px < float(old_.width() - 1) && py < float(old_.height() - 1)))
    return only_new;
  const int u = int(px), v = int(py), right = px - float(u) >= 0.5f, below = py - float(v) >= 0.5f;
  if (std::abs(old_inverse_z_(u + right, v + below) - expected) > kSameSurface * expected)
    return only_new;
  // Shares of 256, two channels of a colour at a time.
  const auto across = std::uint32_t((px - float(u)) * 256),
             down = std::uint32_t((py - float(v)) * 256);
  const auto texel = [&](int i, int k) { return std::bit_cast<std::uint32_t>(old_(u + i, v + k)); };
  const std::uint32_t upper = mix_bytes(texel(0, 0), texel(1, 0), across),
                      lower = mix_bytes(texel(0, 1), texel(1, 1), across);
  return mix_bytes(only_new, mix_bytes(upper, lower, down), weight_);
}

void FrameFade::draw_tile(FrameTile& tile) const {
  const int x_end = std::min(tile.x + FrameTile::kSize, tile.width),
            y_end = std::min(tile.y + FrameTile::kSize, tile.height);
  for (int y = tile.y; y < y_end; ++y)
    for (int x = tile.x; x < x_end; ++x) {
      const TilePixel at(tile, x, y);
      FrameTile::Plane& plane = tile.first[at.block];
      plane.content[at.pixel] =
          tile.of == TileContent::color ? mixed(x, y) : frame_->objects()(x, y);
      plane.inverse_z[at.pixel] = frame_->inverse_z()(x, y);
    }
  std::fill_n(tile.changed, FrameTile::kBlockCount, true);
}

}  // namespace rilievo

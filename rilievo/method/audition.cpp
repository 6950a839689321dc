#include "rilievo/method/audition.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/box_view.h"
#include "rilievo/core/thread_watch.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/method/frame_load.h"
#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// Of what was seen of other frames, when one is added: it is added seldom, and the eye goes on.
constexpr double kRememberedFrames = 0.8;
// Pixels around the bounds of what moves: pictures are filtered, and may be a pixel off.
constexpr double kAroundMoving = 2;
constexpr glm::u8vec4 kCovered{kCoveredPixel & 255, kCoveredPixel >> 8 & 255,
                               kCoveredPixel >> 16 & 255, kCoveredPixel >> 24};

}  // namespace

void FrameLoss::add(const Camera& camera, std::span<const std::uint32_t> objects,
                    const Rgba8Image& color, int times) {
  const std::span shown(reinterpret_cast<const std::uint32_t*>(color.texels().data()),
                        color.texels().size());
  loss_.add(camera, objects, shown, times, kRememberedFrames);
}

std::optional<double> FrameLoss::db() const {
  return loss_.known() ? std::optional(without_own_noise(loss_.loss_db())) : std::nullopt;
}

void leave_out_moving(const PlacedScene& placed, ShownFrame& shown) {
  const glm::dmat4 eye = eye_from_world(shown.camera);
  const auto leaves = [&](std::uint32_t object) {
    if (!placed.scene().objects[object].moving) return false;
    const Box& bounds = placed.bounds()[object];
    if (bounds.empty()) return true;
    const RasterRect rect =
        rect_of_box(shown.camera, view_of_box(eye, bounds, shown.camera.projection));
    const auto within = [](double at, int size) { return int(std::clamp(at, 0.0, double(size))); };
    const int left = within(std::floor(rect.left - kAroundMoving), shown.color.width()),
              right = within(std::ceil(rect.right + kAroundMoving), shown.color.width()),
              top = within(std::floor(rect.top - kAroundMoving), shown.color.height()),
              bottom = within(std::ceil(rect.bottom + kAroundMoving), shown.color.height());
    for (int y = top; y < bottom && left < right; ++y) {
      const std::span row =
          shown.color.row(y).subspan(std::size_t(left), std::size_t(right - left));
      std::fill(row.begin(), row.end(), kCovered);
    }
    return true;
  };
  std::erase_if(shown.in_view, leaves);
  // What is covered counts as right: of a frame that mostly is it is not known how good it is.
  const auto covered = std::ranges::count(shown.color.texels(), kCovered);
  if (2 * std::size_t(covered) > shown.color.texels().size()) shown.by_cache = false;
}

Result<> begin_audition(const ShownFrame& shown, FrameSource& frames) {
  return frames.draw(shown.before, shown.time);
}

Result<double> time_audition(const ShownFrame& shown, FrameSource& frames) {
  const ThreadWatch watch;
  if (Result<> drawn = frames.draw(shown.camera, shown.time); !drawn) return drawn.error();
  return watch.ms();
}

Audition audition_rays(const ShownFrame& shown, int samples, RayVisibility& rays) {
  // Smaller pictures of all that is in view, since a part of the view may cost more than others.
  constexpr int kSmaller = 4;
  Camera camera = shown.camera;
  const double pixels = double(camera.width) * camera.height;
  camera.width = std::max(camera.width / kSmaller, 1);
  camera.height = std::max(camera.height / kSmaller, 1);
  PlacedScene placed(rays.scene());
  placed.set_time(shown.time);
  Audition found;
  const auto cast = [&] {
    return rays.find_visible(camera, samples, placed, shown.in_view, {}).ok();
  };
  // The first time touches memory that others do not.
  if (!cast()) return found;
  const ThreadWatch watch;
  if (!cast()) return found;
  const double times = pixels / (double(camera.width) * camera.height);
  // Colours by the model.
  const FrameLoad shading{.triangles = 0, .pixels = pixels, .threads = 1};
  found.processor_ms = times * watch.ms() + shading.direct_ms();
  return found;
}

std::optional<double> audition_loss(const ShownFrame& shown, const Rgba8Image& color,
                                    FrameLoss& loss) {
  loss.forget();
  for (int i = 0; i < kMostAuditions && (i == 0 || !loss.db()); ++i)
    loss.add(shown.camera, shown.in_view, color, kAuditionLosses);
  return loss.db();
}

std::optional<double> cache_loss(const ShownFrame& shown, FrameLoss* loss) {
  if (!loss || !shown.by_cache) return std::nullopt;
  const std::optional<double> db = audition_loss(shown, shown.color, *loss);
  loss->forget();
  return db;
}

}  // namespace rilievo

#include "bench/layered_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rilievo/core/random.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/layered_impostor/gl/layered_drawable.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/method/stored.h"

namespace rilievo::bench {
namespace {

constexpr std::size_t kTimedEvery = 5;

// Like psnr_db(), over the pixels that show an object in the true frame.
double object_psnr_db(const DrawnFrame& truth, const Rgba8Image& color) {
  std::int64_t sum = 0, count = 0;
  for (std::size_t i = 0; i < color.texels().size(); ++i) {
    if (truth.objects.texels()[i] == kNoObject) continue;
    ++count;
    for (int k = 0; k < 3; ++k) {
      const int d = int(color.texels()[i][k]) - int(truth.color.texels()[i][k]);
      sum += d * d;
    }
  }
  return sum == 0 ? 100.0 : 10 * std::log10(255.0 * 255.0 * 3 * double(count) / double(sum));
}

}  // namespace

Camera camera_on(const Box& box, const glm::dvec3& eye, int size) {
  const glm::dvec3 center(box.center());
  const double radius = box.radius(), distance = glm::length(eye);
  // Away from the poles any up will do.
  const glm::dvec3 up =
      std::abs(eye.y) > 0.99 * distance ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return look_at(center + radius * eye, center, up, 2 * std::asin(1 / distance), size, size,
                 (distance - 1.01) * radius, (distance + 1.01) * radius);
}

std::vector<Camera> random_eyes(const Box& box, const EyeOptions& options) {
  std::vector<Camera> cameras;
  Random random(options.seed);
  for (int i = 0; i < options.count; ++i) {
    const double y = 2.0 * random.unit() - 1, angle = 2 * std::numbers::pi * random.unit();
    const double r = std::sqrt(1 - y * y);
    const glm::dvec3 direction{r * std::cos(angle), y, r * std::sin(angle)};
    const double distance = random.between(float(options.nearest), float(options.farthest));
    cameras.push_back(camera_on(box, distance * direction, options.size));
  }
  return cameras;
}

Result<std::unique_ptr<FrameSource>> impostor_source(SceneRenderer& renderer, LayeredDrawer& drawer,
                                                     LayeredImpostor impostor,
                                                     const LayeredOptions& options) {
  Result<std::unique_ptr<Drawable>> drawable =
      make_layered_drawable(std::move(impostor), drawer, options);
  if (!drawable) return drawable.error();
  PictureSet stored{std::move(*drawable), {{glm::dmat4(1.0), 0, 1}}};
  return {std::make_unique<OpenGLFrames>(
      renderer, std::make_unique<StoredChooser>(std::move(stored), StoredOptions{}))};
}

Result<Quality> measure_quality(OpenGLTarget& target, FrameSource& source,
                                std::span<const Camera> cameras, std::span<const DrawnFrame> truths,
                                int slow_every) {
  std::vector<double> psnr, object_psnr, ssims, flips, times;
  Visibility total;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (i % kTimedEvery == 0) {
      const Result<double> ms = time_frame(source, target, {cameras[i], 0});
      if (!ms) return ms.error();
      times.push_back(*ms);
    }
    const Result<DrawnFrame> shown = draw_frame(source, target, {cameras[i], 0});
    if (!shown) return shown.error();
    const DrawnFrame& truth = truths[i];
    psnr.push_back(std::min(psnr_db(truth.color, shown->color), 100.0));
    object_psnr.push_back(object_psnr_db(truth, shown->color));
    if (i % std::size_t(slow_every) == 0) {
      ssims.push_back(ssim(truth.color, shown->color));
      flips.push_back(flip(truth.color, shown->color));
    }
    const Visibility one = compare_visibility(truth.objects, shown->objects);
    total.counted += one.counted;
    total.wrong += one.wrong;
    total.counted_objects += one.counted_objects;
    total.uncovered += one.uncovered;
  }
  return Quality{summarize(psnr),  summarize(object_psnr),  summarize(ssims),
                 summarize(flips), total.uncovered_share(), total.wrong_share(),
                 median_of(times)};
}

}  // namespace rilievo::bench

#include "rilievo/method/auto_levels.h"

#include <cstring>
#include <utility>

namespace rilievo {
namespace {

// What is taken of an error that only simplification vouches for.
constexpr double kSafely = 0.5;
// So many times the pixels of SampledLoss are looked at in the first frame.
constexpr int kFirstLosses = 16;
// What is lost in one frame is certainly not too much, if it is this share of that.
constexpr double kCertainly = 0.7;

Result<> make_frames(const Backend& backend, double error_px, AutoLevels& levels) {
  Result<std::unique_ptr<LeveledBackend>> made =
      LeveledBackend::create(backend, *std::exchange(levels.made, {}));
  if (!made) return made.error();
  levels.levels = made->get();
  auto chooser = std::make_unique<LevelChooser>(std::move(*made), error_px);
  levels.chooser = chooser.get();
  levels.error_px = error_px;
  Result<std::unique_ptr<FrameSource>> frames =
      levels.levels->backend().make_frames(std::move(chooser));
  if (!frames) return frames.error();
  levels.frames = std::move(*frames);
  return Done{};
}

}  // namespace

void LevelsLoss::add(const Camera& camera, std::span<const std::uint32_t> objects,
                     const Rgba8Image& color, int times) {
  if (shown_.width() != color.width() || shown_.height() != color.height())
    shown_ = Image<std::uint32_t>(color.width(), color.height());
  std::memcpy(shown_.texels().data(), color.texels().data(), color.texels().size_bytes());
  for (int i = 0; i < times; ++i) loss_.add(camera, objects, shown_);
}

std::optional<double> LevelsLoss::db() const {
  return loss_.known() ? std::optional(loss_.loss_db()) : std::nullopt;
}

AutoLevels prepare_levels(const Backend& backend, const Scene& scene,
                          const AutoLevelsOptions& options) {
  AutoLevels levels;
  levels.made = make_object_levels(scene);
  if (options.measure_loss)
    if (Result<RayScene> rays = RayScene::create(scene))
      levels.loss = std::make_unique<LevelsLoss>(std::move(*rays));
  if (backend.drawn_by() != DrawnBy::software) return levels;
  if (!make_frames(backend, kSafely * options.error_px, levels)) return levels;
  if (!levels.loss) {
    static_cast<void>(levels.frames->draw(options.camera, options.time));
    return levels;
  }
  for (const double share : {1.0, kSafely}) {
    levels.error_px = share * options.error_px;
    levels.chooser->set_error(levels.error_px);
    if (!levels.frames->draw(options.camera, options.time)) return levels;
    levels.loss->forget();
    levels.loss->add(options.camera, options.in_view, levels.frames->software_target()->color(),
                     kFirstLosses);
    if (levels.loss->db().value_or(options.loss_db) <= kCertainly * options.loss_db) break;
  }
  return levels;
}

Result<> finish_levels(const Backend& backend, double error_px, AutoLevels& levels) {
  if (levels.frames) return Done{};
  if (!levels.made) return Error{"levels", "there are none"};
  return make_frames(backend, kSafely * error_px, levels);
}

}  // namespace rilievo

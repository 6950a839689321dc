#include "rilievo/method/auto_levels.h"

#include <cstdint>
#include <utility>

#include "rilievo/method/auto_decision.h"
#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// What is taken of an error that only simplification vouches for.
constexpr double kSafely = 0.5;

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

AutoLevels prepare_levels(const Backend& backend, const Scene& scene, double pixels,
                          double error_px) {
  AutoLevels levels;
  LevelsOptions options;
  options.most_triangles = std::uint64_t(FrameLoad::kFits * pixels);
  levels.made = make_object_levels(scene, options);
  if (backend.drawn_by() == DrawnBy::software)
    static_cast<void>(make_frames(backend, kSafely * error_px, levels));
  return levels;
}

Result<> finish_levels(const Backend& backend, double error_px, AutoLevels& levels) {
  if (levels.frames) return Done{};
  if (!levels.made) return Error{"levels", "there are none"};
  return make_frames(backend, kSafely * error_px, levels);
}

Audition audition_levels(const ShownFrame& shown, double error_px, double allowed_db,
                         FrameLoss* loss, AutoLevels& levels) {
  Audition found;
  found.cache_loss_db = cache_loss(shown, loss);
  for (const double share : {1.0, kSafely}) {
    if (!loss && share > kSafely) continue;
    levels.error_px = share * error_px;
    levels.chooser->set_error(levels.error_px);
    const Result<double> ms = time_audition(shown, *levels.frames);
    if (!ms) return found;
    found.processor_ms = *ms;
    if (!loss) return found;
    loss->forget();
    loss->add(shown.camera, shown.in_view, levels.frames->software_target()->color(),
              kAuditionLosses);
    found.loss_db = loss->db();
    if (good_enough(found.loss_db.value_or(allowed_db), found.cache_loss_db,
                    kCertainly * allowed_db))
      break;
  }
  return found;
}

}  // namespace rilievo

#include "rilievo/method/auto_levels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/method/frame_load.h"
#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// What is taken of an error that only simplification vouches for.
constexpr double kSafely = 0.5;
// Levels that are not good enough get so much of the error, or, where they lose much more than they
// may, dB, so much; down to this share of what was asked for.
constexpr double kFiner = 0.7, kMuchFiner = 0.5, kMuchMoreDb = 1.5, kFinest = 0.125;

Result<> make_frames(const Backend& backend, double error_px, AutoLevels& levels) {
  Result<std::unique_ptr<LeveledBackend>> made =
      LeveledBackend::create(backend, *std::exchange(levels.made, {}));
  if (!made) return made.error();
  levels.levels = made->get();
  levels.share = kSafely;
  auto chooser = std::make_unique<LevelChooser>(std::move(*made), levels.share * error_px);
  levels.chooser = chooser.get();
  Result<std::unique_ptr<FrameSource>> frames =
      levels.levels->backend().make_frames(std::move(chooser));
  if (!frames) return frames.error();
  levels.frames = std::move(*frames);
  return Done{};
}

// Where rays do not say what is true: how much worse than polygons are levels of a frame, as if
// polygons were the truth? At the same samples, so that all of the difference is the levels'. None:
// they could not be drawn.
std::optional<double> loss_beside_polygons(const ShownFrame& shown, const Rgba8Image& of_levels,
                                           AutoLevels& levels) {
  levels.chooser->set_error(0);
  if (!levels.frames->draw(shown.camera, shown.time)) return std::nullopt;
  const auto polygons = levels.frames->software_target()->color().texels(),
             shown_levels = of_levels.texels();
  double squares = 0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const glm::vec3 difference = glm::vec3(polygons[i]) - glm::vec3(shown_levels[i]);
    squares += double(glm::dot(difference, difference));
  }
  const double unseen = SampledLoss::kUnseen * double(polygons.size());
  return 10 * std::log10(std::max(squares / unseen, 1.0));
}

}  // namespace

AutoLevels prepare_levels(const Backend& backend, const Scene& scene, double pixels,
                          double error_px) {
  AutoLevels levels;
  LevelsOptions options;
  options.most_triangles = std::uint64_t(FrameLoad::kFew * pixels);
  levels.made = make_object_levels(scene, options);
  if (backend.drawn_by() == DrawnBy::software)
    static_cast<void>(make_frames(backend, error_px, levels));
  return levels;
}

Result<> finish_levels(const Backend& backend, double error_px, AutoLevels& levels) {
  if (levels.frames) return Done{};
  if (!levels.made) return Error{"levels", "there are none"};
  return make_frames(backend, error_px, levels);
}

void follow_error(double error_px, AutoLevels& levels) {
  RILIEVO_EXPECTS(levels.chooser != nullptr);
  levels.chooser->set_error(levels.share * error_px);
}

bool make_finer(double error_px, double excess_db, AutoLevels& levels) {
  if (levels.share <= kFinest) return false;
  levels.share = std::max((excess_db > kMuchMoreDb ? kMuchFiner : kFiner) * levels.share, kFinest);
  follow_error(error_px, levels);
  return true;
}

Audition audition_levels(const ShownFrame& shown, double error_px, double allowed_db,
                         FrameLoss* loss, AutoLevels& levels) {
  Audition found;
  found.cache_loss_db = cache_loss(shown, loss);
  if (!begin_audition(shown, *levels.frames)) return found;
  for (const double share : {1.0, kSafely}) {
    levels.share = share;
    follow_error(error_px, levels);
    const Result<double> ms = time_audition(shown, *levels.frames);
    if (!ms) return found;
    found.processor_ms = *ms;
    const Rgba8Image color = levels.frames->software_target()->color();
    found.loss_db = loss ? audition_loss(shown, color, *loss) : std::nullopt;
    if (!found.loss_db) found.loss_db = loss_beside_polygons(shown, color, levels);
    if (good_enough(found.loss_db.value_or(0), found.cache_loss_db, kCertainly * allowed_db)) break;
  }
  follow_error(error_px, levels);
  return found;
}

}  // namespace rilievo

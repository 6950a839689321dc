#include "rilievo/method/auto_levels.h"

#include <cstdint>
#include <optional>
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

// Is their mean difference at most one step of a byte?
bool look_the_same(const Rgba8Image& a, const Rgba8Image& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i) {
    const glm::vec3 difference = glm::vec3(a.texels()[i]) - glm::vec3(b.texels()[i]);
    squares += double(glm::dot(difference, difference));
  }
  return squares <= SampledLoss::kUnseen * double(a.texels().size());
}

// Where rays do not say what is true: are levels at this error and the polygons that they stand for
// the same to the eye? None: they could not be drawn.
std::optional<Audition> compare_with_polygons(const ShownFrame& shown, double error_px,
                                              AutoLevels& levels) {
  levels.chooser->set_error(0);
  if (!levels.frames->draw(shown.camera, shown.time)) return std::nullopt;
  const Rgba8Image polygons = levels.frames->software_target()->color();
  levels.chooser->set_error(error_px);
  const Result<double> ms = time_audition(shown, *levels.frames);
  if (!ms) return std::nullopt;
  Audition found;
  found.processor_ms = *ms;
  // At the same samples, so that all of the difference is the levels'.
  if (look_the_same(polygons, levels.frames->software_target()->color())) found.loss_db = 0;
  return found;
}

}  // namespace

AutoLevels prepare_levels(const Backend& backend, const Scene& scene, double pixels,
                          double error_px) {
  AutoLevels levels;
  LevelsOptions options;
  options.most_triangles = std::uint64_t(FrameLoad::kFew * pixels);
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
  if (!loss) {
    levels.error_px = error_px;
    const std::optional<Audition> compared = compare_with_polygons(shown, error_px, levels);
    if (compared && compared->loss_db) return *compared;
  }
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

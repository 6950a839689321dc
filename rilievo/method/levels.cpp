#include "rilievo/method/levels.h"

#include <utility>

namespace rilievo {

Result<> LevelChooser::choose(const Camera& camera, const PlacedScene& placed,
                              FrameContent& content, FrameStats& stats) {
  placed.cull(camera, content.polygons);
  stats.bound_px = choose_levels(camera, content.polygons, placed.poses(), placed.bounds(),
                                 error_px_, levels_->levels());
  return Done{};
}

Result<std::unique_ptr<FrameSource>> make_level_frames(const Backend& backend, ObjectLevels levels,
                                                       double error_px) {
  Result<std::unique_ptr<LeveledBackend>> made = LeveledBackend::create(backend, std::move(levels));
  if (!made) return made.error();
  Backend& of = (*made)->backend();
  return of.make_frames(std::make_unique<LevelChooser>(std::move(*made), error_px));
}

}  // namespace rilievo

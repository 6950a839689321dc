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

double count_level_triangles(const Camera& camera, std::span<const std::uint32_t> objects,
                             const PlacedScene& placed, double error_px, LeveledBackend& levels) {
  choose_levels(camera, objects, placed.poses(), placed.bounds(), error_px, levels.levels());
  const Scene& scene = levels.backend().scene();
  double triangles = 0;
  for (const std::uint32_t object : objects)
    triangles += double(scene.models[std::size_t(scene.objects[object].model)].triangles);
  return triangles;
}

Result<std::unique_ptr<FrameSource>> make_level_frames(const Backend& backend, ObjectLevels levels,
                                                       double error_px) {
  Result<std::unique_ptr<LeveledBackend>> made = LeveledBackend::create(backend, std::move(levels));
  if (!made) return made.error();
  Backend& of = (*made)->backend();
  return of.make_frames(std::make_unique<LevelChooser>(std::move(*made), error_px));
}

}  // namespace rilievo

#include "rilievo/frame/gl/level_frames.h"

#include <optional>
#include <utility>

namespace rilievo {

struct LevelFrames::Levels {
  ObjectLevels objects;
  std::optional<SceneRenderer> renderer;  // reads the objects' models for every frame
};

LevelFrames::LevelFrames(std::unique_ptr<Levels> levels, double error_px)
    : SceneFrames(*levels->renderer), levels_(std::move(levels)), error_px_(error_px) {}
LevelFrames::~LevelFrames() = default;

Result<std::unique_ptr<LevelFrames>> LevelFrames::create(ObjectLevels objects, double error_px) {
  auto levels = std::make_unique<Levels>();
  levels->objects = std::move(objects);
  Result<SceneRenderer> renderer = SceneRenderer::create(levels->objects.leveled.scene);
  if (!renderer) return renderer.error();
  levels->renderer.emplace(std::move(*renderer));
  return {std::unique_ptr<LevelFrames>(new LevelFrames(std::move(levels), error_px))};
}

Result<> LevelFrames::choose(const Camera& camera, FrameContent& content, FrameStats& stats) {
  renderer().cull(camera, content.polygons);
  const PlacedScene& placed = renderer().placed();
  stats.bound_px = choose_levels(camera, content.polygons, placed.poses(), placed.bounds(),
                                 error_px_, levels_->objects);
  return Done{};
}

}  // namespace rilievo

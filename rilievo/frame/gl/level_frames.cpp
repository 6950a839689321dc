#include "rilievo/frame/gl/level_frames.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace rilievo {

struct LevelFrames::Levels {
  LeveledScene leveled;
  std::vector<int> model_of;              // by object: of the finest level
  std::optional<SceneRenderer> renderer;  // of leveled.scene
};

LevelFrames::LevelFrames(std::unique_ptr<Levels> levels, double error_px)
    : SceneFrames(*levels->renderer), levels_(std::move(levels)), error_px_(error_px) {}
LevelFrames::~LevelFrames() = default;

Result<std::unique_ptr<LevelFrames>> LevelFrames::create(const Scene& scene, double error_px) {
  auto levels = std::make_unique<Levels>();
  levels->leveled = make_levels(scene);
  for (const Object& object : scene.objects) levels->model_of.push_back(object.model);
  Result<SceneRenderer> renderer = SceneRenderer::create(levels->leveled.scene);
  if (!renderer) return renderer.error();
  levels->renderer.emplace(std::move(*renderer));
  return {std::unique_ptr<LevelFrames>(new LevelFrames(std::move(levels), error_px))};
}

Result<> LevelFrames::choose(const Camera& camera, FrameContent& content, FrameStats& stats) {
  renderer().cull(camera, content.polygons);
  for (const std::uint32_t object : content.polygons) {
    const std::vector<ModelLevel>& all =
        levels_->leveled.levels[std::size_t(levels_->model_of[object])];
    const Box& bounds = renderer().object_bounds(object);
    const glm::dvec3 nearest =
        glm::clamp(camera.position(), glm::dvec3(bounds.min), glm::dvec3(bounds.max));
    const double distance = std::max(glm::length(nearest - camera.position()), camera.z_near);
    const double scale = largest_scale(renderer().poses()[object]);
    // What one pixel in the middle of the frame shows at this distance.
    const double pixel = (camera.window.top - camera.window.bottom) / camera.height * distance;
    const ModelLevel& level = choose_level(all, error_px_ * pixel / std::max(scale, 1e-30));
    // The renderer reads the object's model for every frame.
    levels_->leveled.scene.objects[object].model = level.model;
    stats.bound_px = std::max(stats.bound_px, level.error * scale / pixel);
  }
  return Done{};
}

}  // namespace rilievo

#include "rilievo/render/placed_scene.h"

#include "rilievo/render/draw_list.h"

namespace rilievo {

PlacedScene::PlacedScene(const Scene& scene)
    : scene_(&scene),
      opaque_mesh_(std::make_unique<bool[]>(scene.meshes.size())),
      blended_mesh_(std::make_unique<bool[]>(scene.meshes.size())),
      opaque_model_(std::make_unique<bool[]>(scene.models.size())),
      blended_model_(std::make_unique<bool[]>(scene.models.size())) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const int material = scene.meshes[i].material;
    blended_mesh_[i] =
        material >= 0 && scene.materials[std::size_t(material)].alpha_mode == AlphaMode::blend;
    opaque_mesh_[i] = !blended_mesh_[i];
  }
  for (std::size_t i = 0; i < scene.models.size(); ++i)
    for (const Part& part : scene.models[i].parts)
      (blended_mesh_[std::size_t(part.mesh)] ? blended_model_ : opaque_model_)[i] = true;
  set_time(0);
}

bool PlacedScene::set_time(double time) {
  const bool first = std::isnan(time_);
  if (time == time_) return false;
  time_ = time;
  if (!first && scene_->channels.empty()) return false;
  pose(*scene_, time, poses_);
  bounds_.resize(poses_.size());
  for (std::uint32_t i = 0; i < poses_.size(); ++i)
    if (first || scene_->objects[i].moving)
      bounds_[i] = transformed(poses_[i], scene_->models[model_of(i)].bounds);
  return true;
}

void PlacedScene::update_bounds() {
  for (std::uint32_t i = 0; i < poses_.size(); ++i)
    bounds_[i] = transformed(poses_[i], scene_->models[model_of(i)].bounds);
}

Box PlacedScene::opaque_bounds(std::span<const std::uint32_t> objects) const {
  Box bounds;
  const auto add = [&](std::uint32_t object) {
    if (has_opaque_parts(object)) bounds.add(bounds_[object]);
  };
  for (const std::uint32_t object : objects) add(object);
  if (objects.empty())
    for (std::uint32_t object = 0; object < bounds_.size(); ++object) add(object);
  return bounds;
}

void PlacedScene::cull(const Camera& camera, std::vector<std::uint32_t>& visible) const {
  const Frustum frustum = frustum_of(camera);
  for (std::uint32_t i = 0; i < bounds_.size(); ++i)
    if (may_touch(frustum, bounds_[i])) visible.push_back(i);
}

}  // namespace rilievo

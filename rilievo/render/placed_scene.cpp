#include "rilievo/render/placed_scene.h"

#include <algorithm>

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
    any_strokes_ = any_strokes_ || scene.meshes[i].primitive != Primitive::triangles;
  }
  for (std::size_t i = 0; i < scene.models.size(); ++i)
    for (const Part& part : scene.models[i].parts)
      (blended_mesh_[std::size_t(part.mesh)] ? blended_model_ : opaque_model_)[i] = true;
  stroke_px_.assign(any_strokes_ ? scene.models.size() : 0, 0.0f);
  for (std::size_t i = 0; i < stroke_px_.size(); ++i)
    for (const Part& part : scene.models[i].parts)
      if (const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
          mesh.primitive != Primitive::triangles && mesh.width <= 0)
        stroke_px_[i] = std::max(stroke_px_[i], mesh.width_px);
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

StrokeSize PlacedScene::stroke_size(std::span<const std::uint32_t> objects) const {
  StrokeSize largest;
  if (!any_strokes_) return largest;
  const auto add = [&](std::uint32_t object) {
    for (const Part& part : scene_->models[model_of(object)].parts) {
      const Mesh& mesh = scene_->meshes[std::size_t(part.mesh)];
      if (mesh.primitive == Primitive::triangles) continue;
      const double radius =
          0.5 * double(mesh.width) * smallest_stretch(poses_[object] * part.model_from_mesh);
      largest.add({radius, radius > 0 ? 0.0 : double(mesh.width_px)});
    }
  };
  for (const std::uint32_t object : objects) add(object);
  if (objects.empty())
    for (std::uint32_t object = 0; object < poses_.size(); ++object) add(object);
  return largest;
}

namespace {

// 0, 1, ..., count - 1: std::views::iota does not compile with clang 14 and libstdc++ 12.
struct Numbers {
  struct Iterator {
    std::uint32_t at;
    std::uint32_t operator*() const { return at; }
    Iterator& operator++() {
      ++at;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at != other.at; }
  };
  std::uint32_t count;
  [[nodiscard]] Iterator begin() const { return {0}; }
  [[nodiscard]] Iterator end() const { return {count}; }
};

}  // namespace

template <class Objects>
void PlacedScene::cull_any(const Camera& camera, const Objects& objects,
                           std::vector<std::uint32_t>& visible) const {
  const Frustum frustum = frustum_of(camera);
  const ImageWindow& w = camera.window;
  const double pixel =
      std::max((w.right - w.left) / camera.width, (w.top - w.bottom) / camera.height);
  for (const std::uint32_t i : objects) {
    Box box = bounds_[i];
    if (any_strokes_ && stroke_px_[model_of(i)] > 0 && !box.empty()) {
      // What has its size in pixels reaches beyond the bounds.
      double farthest = 1;
      if (camera.projection != Projection::parallel)
        for (const glm::vec3& corner : box.corners())
          farthest = std::max(farthest, glm::length(glm::dvec3(corner) - camera.position()));
      const float reach = float(double(stroke_px_[model_of(i)]) * double(camera.texels_per_pixel) *
                                pixel * farthest);
      box.min -= reach, box.max += reach;
    }
    if (may_touch(frustum, box)) visible.push_back(i);
  }
}

void PlacedScene::cull(const Camera& camera, std::vector<std::uint32_t>& visible) const {
  cull_any(camera, Numbers{std::uint32_t(bounds_.size())}, visible);
}

void PlacedScene::cull(const Camera& camera, std::span<const std::uint32_t> objects,
                       std::vector<std::uint32_t>& visible) const {
  cull_any(camera, objects, visible);
}

}  // namespace rilievo

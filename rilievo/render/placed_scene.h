// A scene's objects at a moment: where they are, and which of them a camera sees.
//
// Every renderer of whole scenes, with OpenGL or without, uses it: poses and bounds of all objects,
// and which of them have opaque parts and parts that blend. World space, metres.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/stroke_size.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// A scene at a moment.
class PlacedScene {
 public:
  // Places the objects at time 0. `scene` must be valid and outlive the object.
  explicit PlacedScene(const Scene& scene);

  // Places each object at `time` (seconds). Returns false if nothing can have moved.
  bool set_time(double time);
  [[nodiscard]] double time() const { return time_; }
  // The bounds of models have changed (scene/bend.h).
  void update_bounds();

  [[nodiscard]] const Scene& scene() const { return *scene_; }
  // world_from_model and the bounds of each object.
  [[nodiscard]] std::span<const glm::mat4> poses() const { return poses_; }
  [[nodiscard]] std::span<const Box> bounds() const { return bounds_; }
  // Has the object parts that blend (a picture cannot hold them)? Parts that do not?
  [[nodiscard]] bool has_blended_parts(std::uint32_t object) const {
    return blended_model_[model_of(object)];
  }
  [[nodiscard]] bool has_opaque_parts(std::uint32_t object) const {
    return opaque_model_[model_of(object)];
  }
  // Is the mesh opaque or masked? Does it blend? For each of Scene::meshes.
  [[nodiscard]] std::span<const bool> opaque_meshes() const {
    return {opaque_mesh_.get(), scene_->meshes.size()};
  }
  [[nodiscard]] std::span<const bool> blended_meshes() const {
    return {blended_mesh_.get(), scene_->meshes.size()};
  }

  // Together, those of `objects` (empty: all) that have opaque parts.
  [[nodiscard]] Box opaque_bounds(std::span<const std::uint32_t> objects) const;

  // The largest points and lines of these objects; empty: of all.
  [[nodiscard]] StrokeSize stroke_size(std::span<const std::uint32_t> objects) const;

  // Appends the objects whose bounds intersect the camera's frustum.
  void cull(const Camera& camera, std::vector<std::uint32_t>& visible) const;
  // Appends those of `objects`.
  void cull(const Camera& camera, std::span<const std::uint32_t> objects,
            std::vector<std::uint32_t>& visible) const;

 private:
  template <class Objects>
  void cull_any(const Camera& camera, const Objects& objects,
                std::vector<std::uint32_t>& visible) const;
  [[nodiscard]] std::size_t model_of(std::uint32_t object) const {
    return std::size_t(scene_->objects[object].model);
  }

  const Scene* scene_;
  double time_ = NAN;
  bool any_strokes_ = false;
  std::vector<float> stroke_px_;  // by model: the widest of what has its size in pixels
  std::vector<glm::mat4> poses_;
  std::vector<Box> bounds_;
  // std::vector<bool> has no span.
  std::unique_ptr<bool[]> opaque_mesh_, blended_mesh_, opaque_model_, blended_model_;
};

}  // namespace rilievo

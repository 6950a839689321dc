#include "rilievo/render/draw_list.h"

#include <algorithm>

#include "rilievo/core/linear_maps.h"

namespace rilievo {

Frustum frustum_of(const Camera& camera) {
  // Gribb and Hartmann: sums and differences of the rows of the clip matrix.
  glm::dmat4 relative = clip_from_world(camera);
  relative = relative * glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0),
                                   glm::dvec4(0, 0, 1, 0), glm::dvec4(camera.position(), 1));
  const glm::dmat4 rows = glm::transpose(relative);
  Frustum frustum;
  frustum.origin = camera.position();
  for (int i = 0; i < 6; ++i) {
    const glm::dvec4 plane = rows[3] + (i % 2 ? -1.0 : 1.0) * rows[i / 2];
    frustum.planes[i] = glm::vec4(plane / glm::length(glm::dvec3(plane)));
  }
  return frustum;
}

bool may_touch(const Frustum& frustum, const Box& box) {
  if (box.empty()) return false;
  const glm::vec3 center(0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)) - frustum.origin);
  const glm::vec3 half = 0.5f * box.extent();
  for (const glm::vec4& plane : frustum.planes) {
    const glm::vec3 normal(plane);
    // 1e-5 of the numbers involved: rounding must not cull.
    const float reach = glm::dot(glm::abs(normal), half);
    const float slack = 1e-5f * (glm::dot(glm::abs(normal), glm::abs(center)) + reach);
    if (glm::dot(normal, center) + plane.w + reach + slack < 0) return false;
  }
  return true;
}

void DrawList::sort_by_distance(const Camera& camera, std::span<const std::uint32_t> objects,
                                std::span<const Box> bounds) {
  keys_.clear();
  const glm::dvec3 eye = camera.position();
  for (std::uint32_t object : objects) {
    const glm::vec3 to(glm::dvec3(bounds[object].center()) - eye);
    keys_.push_back({glm::dot(to, to), object});
  }
  // Through an apex behind the object, what is seen first is what lies farthest.
  const float sign = camera.keeps_farthest() ? -1.0f : 1.0f;
  std::sort(keys_.begin(), keys_.end(), [sign](const Key& a, const Key& b) {
    return a.distance != b.distance ? sign * a.distance < sign * b.distance : a.object < b.object;
  });
}

void DrawList::build_front_to_back(const Scene& scene, const Camera& camera,
                                   std::span<const std::uint32_t> objects,
                                   std::span<const glm::mat4> poses, std::span<const Box> bounds,
                                   std::span<const bool> mesh_included) {
  sort_by_distance(camera, objects, bounds);
  batches_.clear();
  batch_of_.assign(scene.meshes.size() * 2, -1);

  const auto for_each_instance = [&](auto&& visit) {
    for (const Key& key : keys_) {
      const Object& object = scene.objects[key.object];
      const glm::mat4 pose = relative_to(camera.position(), poses[key.object]);
      const bool mirrored_object = is_mirroring(glm::dmat3(pose));
      for (const Part& part : scene.models[std::size_t(object.model)].parts) {
        const auto mesh = std::uint32_t(part.mesh);
        if (!mesh_included[mesh]) continue;
        const bool mirrored = mirrored_object != is_mirroring(glm::dmat3(part.model_from_mesh));
        visit(mesh, mirrored, key.object, pose, part);
      }
    }
  };

  // Count, so that each batch's instances can lie together ...
  for_each_instance([&](std::uint32_t mesh, bool mirrored, auto&&...) {
    std::int32_t& batch = batch_of_[mesh * 2 + mirrored];
    if (batch < 0) {
      batch = std::int32_t(batches_.size());
      batches_.push_back({mesh, mirrored, 0, 0});
    }
    ++batches_[std::size_t(batch)].count;
  });
  std::uint32_t total = 0;
  for (Batch& batch : batches_) {
    batch.first = total;
    total += batch.count;
    batch.count = 0;
  }
  // ... then place, in the same order.
  instances_.resize(total);
  for_each_instance([&](std::uint32_t mesh, bool mirrored, std::uint32_t object,
                        const glm::mat4& pose, const Part& part) {
    Batch& batch = batches_[std::size_t(batch_of_[mesh * 2 + mirrored])];
    instances_[batch.first + batch.count++] = {object, pose * part.model_from_mesh};
  });
}

void DrawList::build_back_to_front(const Scene& scene, const Camera& camera,
                                   std::span<const std::uint32_t> objects,
                                   std::span<const glm::mat4> poses, std::span<const Box> bounds,
                                   std::span<const bool> mesh_included) {
  sort_by_distance(camera, objects, bounds);
  batches_.clear();
  instances_.clear();
  for (auto key = keys_.rbegin(); key != keys_.rend(); ++key) {
    const glm::mat4 pose = relative_to(camera.position(), poses[key->object]);
    for (const Part& part : scene.models[std::size_t(scene.objects[key->object].model)].parts) {
      if (!mesh_included[std::size_t(part.mesh)]) continue;
      const glm::mat4 placement = pose * part.model_from_mesh;
      batches_.push_back({std::uint32_t(part.mesh), is_mirroring(glm::dmat3(placement)),
                          std::uint32_t(instances_.size()), 1});
      instances_.push_back({key->object, placement});
    }
  }
}

}  // namespace rilievo

// Which objects does a camera see, and in which order and batches are their meshes drawn?
//
// Pure; no OpenGL. Buffers are kept between calls, so that a steady frame allocates nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The six planes of a camera's frustum; a point is inside where every plane is >= 0. Relative to
// the camera's position, so that floats suffice.
struct Frustum {
  glm::dvec3 origin{0.0};
  glm::vec4 planes[6];
};
[[nodiscard]] Frustum frustum_of(const Camera& camera);
// Conservative: may say yes to a box near an edge of the frustum, never no to one that reaches in.
[[nodiscard]] bool may_touch(const Frustum& frustum, const Box& box);

// A run of instances of one mesh.
struct Batch {
  std::uint32_t mesh = 0;
  bool mirrored = false;               // placements that turn the mesh inside out
  std::uint32_t first = 0, count = 0;  // into DrawList::instances
};

struct Placement {
  std::uint32_t object = 0;
  glm::mat4 relative_from_mesh;  // relative to the camera's position, world axes
};

class DrawList {
 public:
  // One batch a mesh; batches ordered by their nearest instance, instances front to back.
  // `include(material)` chooses the meshes. Sorted by the distance of the objects' bounds' centres.
  void build_front_to_back(const Scene& scene, const Camera& camera,
                           std::span<const std::uint32_t> objects, std::span<const glm::mat4> poses,
                           std::span<const Box> bounds, std::span<const bool> mesh_included);
  // One batch an instance, farthest first.
  void build_back_to_front(const Scene& scene, const Camera& camera,
                           std::span<const std::uint32_t> objects, std::span<const glm::mat4> poses,
                           std::span<const Box> bounds, std::span<const bool> mesh_included);

  [[nodiscard]] std::span<const Batch> batches() const { return batches_; }
  [[nodiscard]] std::span<const Placement> instances() const { return instances_; }

 private:
  struct Key {
    float distance;
    std::uint32_t object;
  };
  void sort_by_distance(const Camera& camera, std::span<const std::uint32_t> objects,
                        std::span<const Box> bounds);

  std::vector<Key> keys_;
  std::vector<Batch> batches_;
  std::vector<Placement> instances_;
  std::vector<std::int32_t> batch_of_;  // by mesh * 2 + mirrored
};

}  // namespace rilievo

// Which objects does a camera see, and in which order and batches are their meshes drawn?
//
// Pure; no OpenGL. Buffers are kept between calls, so that a steady frame does not allocate.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The six planes of a camera's frustum. A point is inside if no plane is negative there.
// Coordinates are relative to the camera's position, so that single precision suffices.
struct Frustum {
  glm::dvec3 origin{0.0};
  glm::vec4 planes[6];
};
// The frustum of a camera.
[[nodiscard]] Frustum frustum_of(const Camera& camera);
// Does `box` intersect the frustum? Conservative: can be true for a box near an edge of the
// frustum, never false for one that intersects it.
[[nodiscard]] bool may_touch(const Frustum& frustum, const Box& box);

// A range of instances of one mesh.
struct Batch {
  std::uint32_t mesh = 0;
  bool mirrored = false;               // the placements have negative determinants
  std::uint32_t first = 0, count = 0;  // range in DrawList::instances
};

// One mesh of one object, placed.
struct Placement {
  std::uint32_t object = 0;
  glm::mat4 relative_from_mesh;  // relative to the camera's position, world axes
};

// The batches of a frame, in drawing order.
class DrawList {
 public:
  // One batch for each mesh, for opaque parts. Batches are ordered by their nearest instance, the
  // instances of a batch front to back, both by the distance of the objects' bounds' centres.
  // `mesh_included` selects the meshes; `poses` and `bounds` are those of all objects.
  void build_front_to_back(const Scene& scene, const Camera& camera,
                           std::span<const std::uint32_t> objects, std::span<const glm::mat4> poses,
                           std::span<const Box> bounds, std::span<const bool> mesh_included);
  // One batch for each instance, farthest first, for blended parts.
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

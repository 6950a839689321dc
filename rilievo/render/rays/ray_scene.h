// What does a ray meet in a Scene?
//
// Embree answers; objects are instances of their models. What a picture cannot hold is not there:
// back faces of single-sided materials, masked-out texels, blended parts. A mask's texture is read
// as it is; rays of a picture read it at the level that the picture's texels ask for. World space,
// metres; single precision inside. After create() all calls may come from any number of threads at
// once.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/render/shading/surface.h"
#include "rilievo/render/shading/surface_materials.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

struct RayHit {
  float distance = 0;           // in lengths of the ray's direction
  std::uint32_t object = 0;     // index into Scene::objects + 1
  int part = 0;                 // of the object's model
  std::uint32_t triangle = 0;   // of the part's mesh
  glm::vec2 barycentric{0.0f};  // weights of the triangle's second and third corner
  glm::vec3 normal{0.0f};       // geometric, unit, world; on the front side
};

// Which sides of single-sided surfaces does a ray meet?
enum class RaySides {
  seen,  // fronts
  both,
};

// Up to 16 rays that take similar ways, and what they meet first.
struct RayPacket {
  static constexpr int kMaxCount = 16;
  int count = 0;
  alignas(64) float origin[3][kMaxCount], direction[3][kMaxCount];  // world
  alignas(64) float t_near[kMaxCount], t_far[kMaxCount];            // in lengths of `direction`
  // Of each, where it met something before t_far.
  alignas(64) float distance[kMaxCount];
  std::uint32_t object[kMaxCount];  // index into Scene::objects + 1; 0: nothing was met
  std::uint32_t triangle[kMaxCount];
  int part[kMaxCount];  // of the object's model
};

// What rays of a picture see alone, and how large its texels are.
struct RayPictureView {
  PictureRays rays;
  glm::dvec3 position{0.0};       // the camera's
  std::span<const bool> objects;  // by index into Scene::objects: is it there? Empty: all are
};

class RayScene {
 public:
  // `scene` must outlive it; objects are placed where they are at `time`.
  [[nodiscard]] static Result<RayScene> create(const Scene& scene, double time = 0.0);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  // The first surface met at a distance in (t_near, t_far), in lengths of `direction`.
  [[nodiscard]] std::optional<RayHit> first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                                float t_near, float t_far,
                                                RaySides sides = RaySides::seen) const;
  // The same of rays of a picture.
  [[nodiscard]] std::optional<RayHit> first_hit(const RayPictureView& view, const glm::vec3& origin,
                                                const glm::vec3& direction, float t_near,
                                                float t_far) const;
  void first_hits(const RayPictureView& view, RayPacket& packet) const;
  [[nodiscard]] bool occluded(const glm::vec3& origin, const glm::vec3& direction, float t_near,
                              float t_far) const;

  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] const std::vector<glm::mat4>& poses() const;
  [[nodiscard]] const SurfaceMaterials& materials() const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  [[nodiscard]] std::optional<RayHit> first_hit(const RayPictureView* view, RaySides sides,
                                                const glm::vec3& origin, const glm::vec3& direction,
                                                float t_near, float t_far) const;
  std::unique_ptr<State> state_;
};

// The material's base colour there (factor, texture as it is, vertex colour): linear, straight
// alpha.
[[nodiscard]] glm::vec4 base_color_at(const Scene& scene, int mesh, std::uint32_t triangle,
                                      const glm::vec2& barycentric);

// Is this triangle in pictures, seen from its back too? nullopt: blended, so not in pictures.
[[nodiscard]] std::optional<bool> double_sided(const Scene& scene, int mesh);

}  // namespace rilievo

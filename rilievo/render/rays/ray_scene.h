// A Scene for rays: what they hit.
//
// Uses Embree; objects are instances of their models. Surfaces that a picture cannot hold are
// absent: back faces of single-sided materials, masked-out texels, blended parts unless asked for.
// Masks are read at a texture's full resolution, except by rays of a picture, which read the mip
// level for the picture's texels. World space, metres; single precision inside. After create(), all
// functions can be called by any number of threads at once.
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

// The intersection of a ray with a surface.
struct RayHit {
  float distance = 0;           // as a multiple of the length of the ray's direction
  std::uint32_t object = 0;     // index into Scene::objects + 1
  int part = 0;                 // of the object's model
  std::uint32_t triangle = 0;   // of the part's mesh
  glm::vec2 barycentric{0.0f};  // weights of the triangle's second and third corner
  glm::vec3 normal{0.0f};       // geometric, unit, world space; on the front side
};

// The sides of single-sided surfaces that a ray hits.
enum class RaySides {
  seen,  // fronts
  both,
};

// The parts of a scene that rays hit.
enum class RayParts {
  opaque,   // those that a picture can hold, but for points and lines (rays/stroke_hits.h)
  all,      // blended parts, too
  strokes,  // opaque ones, and points as balls and lines as round rods: as wide as they are, or,
            // where that is in pixels, as a thousandth of their model's bounds
};

// Up to 16 similar rays and their first hits.
struct RayPacket {
  static constexpr int kMaxCount = 16;
  int count = 0;
  alignas(64) float origin[3][kMaxCount], direction[3][kMaxCount];  // world space
  alignas(64) float t_near[kMaxCount],
      t_far[kMaxCount];  // as multiples of the length of `direction`
  // The first hit of each ray before t_far.
  alignas(64) float distance[kMaxCount];
  std::uint32_t object[kMaxCount];  // index into Scene::objects + 1; 0: no hit
  std::uint32_t triangle[kMaxCount];
  int part[kMaxCount];  // of the object's model
};

// The view of a picture whose rays are cast: the objects that they hit, and the size of its texels.
struct RayPictureView {
  PictureRays rays;
  glm::dvec3 position{0.0};       // the camera's
  std::span<const bool> objects;  // for each of Scene::objects: can it be hit? Empty: all can
};

struct RayContext;  // internal

// A mask over a scene's objects, for RayScene::first_hit.
class ObjectSet {
 public:
  // `objects`: indices; empty: all.
  ObjectSet(const Scene& scene, std::span<const std::uint32_t> objects);
  // For each object, whether the set contains it. Empty if the set contains all.
  operator std::span<const bool>() const { return {included_.get(), size_}; }

 private:
  std::unique_ptr<bool[]> included_;
  std::size_t size_ = 0;
};

// A scene in Embree.
class RayScene {
 public:
  // Builds the scene with objects placed at `time` (seconds). `scene` must outlive the object.
  // Fails if memory does not suffice.
  [[nodiscard]] static Result<RayScene> create(const Scene& scene, double time = 0.0,
                                               RayParts parts = RayParts::opaque);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  // Places each object at `time` (seconds). No other function may run meanwhile. Fails if memory
  // does not suffice.
  Result<> set_time(double time);

  // Takes the positions of these meshes' vertices (indices into Scene::meshes) from the scene
  // again, which has bent them: as many vertices, and the same triangles. Builds their models anew,
  // and nothing else; the result is that of create(). No other function may run meanwhile. Fails if
  // memory does not suffice.
  Result<> update_meshes(std::span<const int> meshes);

  // Lets rays hit these objects only (empty: all), until the next call. Others take a ray no time,
  // as they do where a function below is told which objects it may hit. No other function may run
  // meanwhile. Fails if memory does not suffice.
  Result<> keep_objects(std::span<const std::uint32_t> objects);

  // The first hit at a distance in (t_near, t_far), as multiples of the length of `direction`, of
  // the objects for which `objects` is true (empty: of all).
  [[nodiscard]] std::optional<RayHit> first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                                float t_near, float t_far,
                                                RaySides sides = RaySides::seen,
                                                std::span<const bool> objects = {}) const;
  // The same for rays of a picture.
  [[nodiscard]] std::optional<RayHit> first_hit(const RayPictureView& view, const glm::vec3& origin,
                                                const glm::vec3& direction, float t_near,
                                                float t_far) const;
  void first_hits(const RayPictureView& view, RayPacket& packet) const;
  // Is there any hit at a distance in (t_near, t_far)?
  [[nodiscard]] bool occluded(const glm::vec3& origin, const glm::vec3& direction, float t_near,
                              float t_far) const;

  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] RayParts parts() const;  // that rays can hit
  // world_from_model of each object.
  [[nodiscard]] const std::vector<glm::mat4>& poses() const;
  [[nodiscard]] const SurfaceMaterials& materials() const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  [[nodiscard]] std::optional<RayHit> first_hit(RayContext&& context, const glm::vec3& origin,
                                                const glm::vec3& direction, float t_near,
                                                float t_far) const;
  std::unique_ptr<State> state_;
};

// The material's base colour at a point (factor, texture at full resolution, vertex colour):
// linear, straight alpha.
[[nodiscard]] glm::vec4 base_color_at(const Scene& scene, int mesh, std::uint32_t triangle,
                                      const glm::vec2& barycentric);

// Is the mesh visible from both sides? None for blended meshes, which are not in pictures.
[[nodiscard]] std::optional<bool> double_sided(const Scene& scene, int mesh);

}  // namespace rilievo

// A model as Embree holds it, and what of it a ray may hit.
#pragma once

#include <embree3/rtcore.h>

#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/surface_materials.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// What a ray takes along.
struct RayContext {
  RTCIntersectContext embree;  // the first member: Embree hands on a pointer to it
  const RayPictureView* picture = nullptr;
  std::span<const glm::mat4> model_from_world;
  RaySides sides = RaySides::seen;
  std::span<const bool> objects;  // for each: can it be hit? Empty: all can
};

// Robust: else rays slip through between triangles that share an edge. And a filter of the context
// is not called otherwise where a part has none of its own.
inline const RTCSceneFlags kEmbreeFlags =
    RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

// What the filter of one geometry needs to know.
struct PartFilter {
  const Mesh* mesh;
  glm::vec3* vertices;  // of the mesh, in model space: Embree's buffer
  const SurfaceMaterial* material;
  float front;  // -1 where the part's placement mirrors: its front is then clockwise
};

struct EmbreeSceneDeleter {
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
};
using EmbreeScene = std::unique_ptr<RTCSceneTy, EmbreeSceneDeleter>;

// A model in Embree.
struct EmbreeModel {
  EmbreeScene scene;
  std::vector<std::unique_ptr<PartFilter>> filters;  // of each geometry
};

// A filter of a context: rejects objects that are not in its picture.
void filter_objects(const RTCFilterFunctionNArguments* arguments);

// What models are built of.
struct EmbreeModelOptions {
  RTCDevice device = nullptr;
  const Scene* scene = nullptr;
  const SurfaceMaterials* materials = nullptr;
  RayParts included = RayParts::opaque;
};

// Model number `of`, placed by a matrix that its vertices take; and, in `part_of`, the part of each
// geometry. Fails where memory does not suffice.
[[nodiscard]] Result<EmbreeModel> build_embree_model(const EmbreeModelOptions& options, int of,
                                                     const glm::dmat4& to_from_model,
                                                     std::vector<int>& part_of);

// Takes the vertices of these meshes again; whether the model has any of them.
bool rebuild_embree_model(const Model& model, std::span<const int> part_of,
                          const glm::dmat4& to_from_model, std::span<const int> meshes,
                          EmbreeModel& built);

}  // namespace rilievo

#include "bench/relief_objects.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "rilievo/layered_relief/relief_set.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {

Result<ReliefObject> relief_object(const char* name) {
  Result<BuiltinScene> built = make_builtin(std::string("builtin:") + name);
  if (!built) return built.error();
  ReliefObject object{name, std::make_unique<Scene>(std::move(built->scene)), std::nullopt};
  Result<RayScene> rays = RayScene::create(*object.scene);
  if (!rays) return rays.error();
  object.rays.emplace(std::move(*rays));
  return object;
}

double paper_ball(const ReliefObject& object) {
  return std::string_view(object.name) == "cube" ? 1.11 : 0.0;
}

Result<LayeredDepthImage> relief_layers(const ReliefObject& object, int size,
                                        const glm::dvec3& direction) {
  const Box box = world_bounds(*object.scene);
  Result<Camera> camera = relief_camera(box, direction, size, std::max(paper_ball(object), 1.0));
  if (!camera) return camera.error();
  if (paper_ball(object) == 0) {
    // A square around what is seen. The objects stand where their meshes do.
    const glm::dmat4 eye_from = eye_from_world(*camera);
    glm::dvec2 low(1e300), high(-1e300);
    for (const Mesh& mesh : object.scene->meshes)
      for (const glm::vec3& p : mesh.positions) {
        const glm::dvec2 at(eye_from * glm::dvec4(p, 1));
        low = glm::min(low, at), high = glm::max(high, at);
      }
    const glm::dvec2 middle = 0.5 * (low + high);
    const double half = 0.5001 * std::max(high.x - low.x, high.y - low.y);
    camera->window = {middle.x - half, middle.x + half, middle.y - half, middle.y + half};
  }
  LayeredDepthImage layers =
      cast_layers(*object.rays, *camera, {.merge = 0.01 * texel_angle(*camera)});
  layers.name = object.name;
  return layers;
}

}  // namespace rilievo::bench

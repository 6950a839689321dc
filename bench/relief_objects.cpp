#include "bench/relief_objects.h"

#include <algorithm>
#include <string>

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

Result<LayeredDepthImage> relief_layers(const ReliefObject& object, int size,
                                        const glm::dvec3& direction, double margin) {
  const Box box = world_bounds(*object.scene);
  const glm::dvec3 eye = glm::dvec3(box.center()) + 3.0 * double(box.radius()) * direction;
  Result<Camera> camera = tight_camera(Projection::parallel, eye, {0, 1, 0}, box);
  if (!camera) return camera.error();
  // Square texels.
  ImageWindow& w = camera->window;
  const double half = 0.5 * margin * std::max(w.right - w.left, w.top - w.bottom);
  const double x = 0.5 * (w.left + w.right), y = 0.5 * (w.bottom + w.top);
  w = {x - half, x + half, y - half, y + half};
  camera->width = camera->height = size;
  LayeredDepthImage layers =
      cast_layers(*object.rays, *camera, {.merge = 0.01 * texel_angle(*camera)});
  layers.name = object.name;
  return layers;
}

}  // namespace rilievo::bench

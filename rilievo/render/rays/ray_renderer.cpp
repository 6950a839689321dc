#include "rilievo/render/rays/ray_renderer.h"

#include <utility>

namespace rilievo {

Result<std::unique_ptr<RayRenderer>> RayRenderer::create(const Scene& scene) {
  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  return {std::unique_ptr<RayRenderer>(new RayRenderer(std::move(*rays)))};
}

Result<> RayRenderer::set_time(double time) { return rays_.set_time(time); }

Result<> RayRenderer::draw(const Camera& camera, int samples, RasterPicture& picture) {
  caster_.draw(camera, {}, samples, picture);
  return Done{};
}

Result<> RayRenderer::draw_objects(const Camera& camera, ObjectPicture& picture) {
  caster_.draw_objects(camera, picture);
  return Done{};
}

}  // namespace rilievo

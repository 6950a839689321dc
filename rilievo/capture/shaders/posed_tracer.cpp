#include "rilievo/capture/shaders/posed_tracer.h"

#include <algorithm>
#include <cmath>

#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/core/expects.h"

namespace rilievo {

PosedTracer::PosedTracer(const Scene& scene, const Deformations& deformations,
                         std::span<const DeformationBounds> bounds, double placed,
                         const TraceOptions& options)
    : scene_(scene), deformations_(deformations), time_(NAN), options_(options) {
  for (const Deformation& deformation : deformations_.meshes) meshes_.push_back(deformation.mesh);
  std::vector<glm::mat4> poses;
  pose(scene_, placed, poses);
  for (std::uint32_t object = 0; object < scene_.objects.size(); ++object) {
    const auto model = std::size_t(scene_.objects[object].model);
    bounds_.push_back(scene_.models[model].parts.empty()
                          ? Box()
                          : transformed(poses[object], bounds[model].bounds));
  }
}

Result<std::unique_ptr<PosedTracer>> PosedTracer::create(const Scene& scene,
                                                         const Deformations& deformations,
                                                         std::span<const DeformationBounds> bounds,
                                                         double placed,
                                                         const TraceOptions& options) {
  RILIEVO_EXPECTS(bounds.size() == scene.models.size());
  std::unique_ptr<PosedTracer> tracer(
      new PosedTracer(scene, deformations, bounds, placed, options));
  Result<RayScene> rays = RayScene::create(tracer->scene_, placed, RayParts::all);
  if (!rays) return rays.error();
  tracer->rays_.emplace(std::move(*rays));
  return {std::move(tracer)};
}

Box PosedTracer::bounds(std::span<const std::uint32_t> objects) const {
  Box all;
  for (const std::uint32_t object : objects) all.add(bounds_[object]);
  if (objects.empty())
    for (const Box& box : bounds_) all.add(box);
  return all;
}

Result<CapturedPicture> PosedTracer::capture(const CaptureRequest& request) {
  if (request.time != time_) {
    time_ = NAN;
    bend(deformations_, request.time, scene_);
    if (Result<> updated = rays_->update_meshes(meshes_); !updated) return updated.error();
    time_ = request.time;
  }
  return RayTracer(*rays_, options_).capture(request);
}

}  // namespace rilievo

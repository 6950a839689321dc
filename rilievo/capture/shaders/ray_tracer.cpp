#include "rilievo/capture/shaders/ray_tracer.h"

#include "rilievo/capture/shaders/refine_picture.h"
#include "rilievo/core/random.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/stroke_hits.h"

namespace rilievo {
namespace {

// The rays of one picture.
class TracedRays final : public RayShader {
 public:
  TracedRays(const RayScene& rays, const CaptureRequest& request, const TraceOptions& options)
      : camera_(request.camera),
        rays_(rays),
        objects_(rays.scene(), request.objects),
        picture_rays_(picture_rays(camera_)),
        strokes_(rays, camera_, objects_),
        tracer_(rays, picture_rays_, camera_.position(), objects_, options) {}

  [[nodiscard]] std::optional<Seen> nearest(const glm::dvec2& raster) const override {
    const CameraRay ray = camera_ray(camera_, raster);
    const auto hit = strokes_.nearer(raster, tracer_.first_hit(ray.origin, ray.direction));
    if (!hit) return std::nullopt;
    return Seen{float(ray.eye_z_start + double(hit->distance) * ray.eye_z_step), hit->object};
  }

  [[nodiscard]] float farthest(const glm::dvec2& raster) const override {
    return farthest_eye_z(rays_, camera_, raster, strokes_);
  }

  [[nodiscard]] glm::vec4 light(int x, int y, const glm::dvec2& place, int sample) const override {
    const glm::dvec2 raster(x + place.x, y + 1 - place.y);
    const CameraRay ray = camera_ray(camera_, raster);
    const auto hit = strokes_.nearer(raster, tracer_.first_hit(ray.origin, ray.direction));
    if (!hit) return glm::vec4(0.0f);
    const glm::vec3 way =
        picture_rays_.through(float(x + place.x), float(camera_.height - 1 - y + place.y));
    return tracer_.light(*hit, way, {combine(std::uint64_t(x), std::uint64_t(y)), sample});
  }

 private:
  const Camera& camera_;
  const RayScene& rays_;
  ObjectSet objects_;
  PictureRays picture_rays_;
  StrokeHits strokes_;
  LightTracer tracer_;
};

}  // namespace

Box RayTracer::bounds(std::span<const std::uint32_t> objects) const {
  const Scene& scene = rays_.scene();
  Box bounds;
  const auto add = [&](std::uint32_t object) {
    const Model& model = scene.models[std::size_t(scene.objects[object].model)];
    if (!model.parts.empty()) bounds.add(transformed(rays_.poses()[object], model.bounds));
  };
  for (const std::uint32_t object : objects) add(object);
  if (objects.empty())
    for (std::uint32_t object = 0; object < scene.objects.size(); ++object) add(object);
  return bounds;
}

Result<CapturedPicture> RayTracer::capture(const CaptureRequest& request) {
  return refine_picture(TracedRays(rays_, request, options_), request, name());
}

Result<LayeredDepthImage> RayTracer::capture_layers(const LayersRequest& request) {
  const Camera& camera = request.camera;
  if (Result<> valid = validate(camera); !valid) return valid.error();
  if (camera.projection == Projection::back_perspective)
    return Error{std::string(name()), "layers need a perspective or a parallel camera"};
  if (request.samples < 1 || request.samples > 4096)
    return Error{std::string(name()), "software shaders take 1 to 4096 samples per texel"};
  const Scene& scene = rays_.scene();
  const ObjectSet objects(scene, request.objects);
  const PictureRays rays = picture_rays(camera);
  const LightTracer tracer(rays_, rays, camera.position(), objects, options_);
  const auto light = [&](const RayHit& hit, int x, int y) -> std::optional<glm::vec4> {
    if (surface_material(rays_, hit).blended) {
      const int mesh = mesh_of_hit(rays_, hit);
      if (!scene.materials[std::size_t(scene.meshes[std::size_t(mesh)].material)].refracts)
        return std::nullopt;
    }
    const glm::vec3 way = rays.through(float(x) + 0.5f, float(camera.height - 1 - y) + 0.5f);
    glm::vec4 sum(0.0f);
    for (int s = 0; s < request.samples; ++s)
      sum += tracer.light(hit, way, {combine(std::uint64_t(x), std::uint64_t(y)), s});
    return sum / float(request.samples);
  };
  LayeredDepthImage layers =
      cast_layers(rays_, camera, {request.merge, request.max_layers, request.objects}, light);
  layers.name = name();
  return layers;
}

}  // namespace rilievo

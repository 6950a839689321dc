#include "rilievo/capture/ray_source.h"

#include <utility>
#include <vector>

#include "rilievo/capture/bound_thin_texels.h"
#include "rilievo/capture/least_roughness.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/stroke_hits.h"

namespace rilievo {
namespace {

bool has_opaque_parts(const Scene& scene, const Model& model) {
  for (const Part& part : model.parts)
    if (double_sided(scene, part.mesh)) return true;
  return false;
}

Image<float> cast_farthest(const RayScene& rays, const Camera& camera,
                           std::span<const std::uint32_t> objects) {
  const ObjectSet set(rays.scene(), objects);
  const StrokeHits strokes(rays, camera, set);
  Image<float> farthest(camera.width, camera.height, kNoDepth);
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x)
      farthest(x, y) = farthest_eye_z(rays, camera, {x + 0.5, y + 0.5}, strokes);
  });
  return farthest;
}

}  // namespace

Box RaySource::bounds(std::span<const std::uint32_t> objects) const {
  const Scene& scene = rays_.scene();
  Box bounds;
  const auto add = [&](std::uint32_t object) {
    const Model& model = scene.models[std::size_t(scene.objects[object].model)];
    if (has_opaque_parts(scene, model))
      bounds.add(transformed(rays_.poses()[object], model.bounds));
  };
  for (const std::uint32_t object : objects) add(object);
  if (objects.empty())
    for (std::uint32_t object = 0; object < scene.objects.size(); ++object) add(object);
  return bounds;
}

Result<CapturedPicture> RaySource::capture(const CaptureRequest& request) {
  if (Result<> valid = validate(request.camera); !valid) return valid.error();
  if (request.samples != 1 && request.samples != 4)
    return Error{std::string(name()), "rays capture 1 or 4 samples per texel"};
  if (request.with_sky && request.camera.keeps_farthest())
    return Error{std::string(name()), "a back-perspective camera sees no sky"};
  if (Result<> fits = strokes_fit(rays_.scene(), request.camera); !fits) return fits.error();
  RILIEVO_EXPECTS(!(request.staggered && request.farthest));
  CapturedPicture captured{
      cast_picture(rays_, request.camera,
                   {request.objects, request.samples, request.with_sky, request.staggered}),
      {}};
  captured.picture.name = name();
  if (!request.identifiers) captured.picture.object = {};
  if (request.farthest) captured.farthest = cast_farthest(rays_, request.camera, request.objects);
  bound_thin_texels(captured);
  return captured;
}

Result<LayeredDepthImage> RaySource::capture_layers(const LayersRequest& request) {
  if (Result<> valid = validate(request.camera); !valid) return valid.error();
  if (request.camera.projection == Projection::back_perspective)
    return Error{std::string(name()), "layers need a perspective or a parallel camera"};
  LayeredDepthImage layers = cast_layers(
      rays_, request.camera,
      {request.merge, request.max_layers, request.objects, least_roughness(request.camera)});
  layers.name = name();
  return layers;
}

}  // namespace rilievo

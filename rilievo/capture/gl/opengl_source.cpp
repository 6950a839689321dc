#include "rilievo/capture/gl/opengl_source.h"

#include <utility>
#include <vector>

#include "rilievo/capture/bound_thin_texels.h"
#include "rilievo/capture/gl/capture_layers.h"
#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/capture/least_roughness.h"

namespace rilievo {

Box OpenGLSource::bounds(std::span<const std::uint32_t> objects) const {
  return renderer_.placed().opaque_bounds(objects);
}

Result<CapturedPicture> OpenGLSource::capture(const CaptureRequest& request) {
  std::vector<std::uint32_t> objects(request.objects.begin(), request.objects.end());
  if (objects.empty()) renderer_.cull(request.camera, objects);
  Result<DepthImage> picture = capture_picture(
      renderer_, request.camera, objects, {request.samples, request.identifiers, request.with_sky});
  if (!picture) return picture.error();
  CapturedPicture captured{std::move(*picture), {}};
  if (!request.farthest) return captured;
  Result<Image<float>> farthest = capture_farthest(renderer_, request.camera, objects);
  if (!farthest) return farthest.error();
  captured.farthest = std::move(*farthest);
  bound_thin_texels(captured);
  return captured;
}

Result<LayeredDepthImage> OpenGLSource::capture_layers(const LayersRequest& request) {
  std::vector<std::uint32_t> objects(request.objects.begin(), request.objects.end());
  if (objects.empty()) renderer_.cull(request.camera, objects);
  return rilievo::capture_layers(
      renderer_, request.camera, objects,
      {request.merge, request.max_layers, least_roughness(request.camera)});
}

}  // namespace rilievo

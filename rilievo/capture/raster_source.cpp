#include "rilievo/capture/raster_source.h"

#include <algorithm>
#include <string>
#include <utility>

#include "rilievo/capture/bound_thin_texels.h"
#include "rilievo/capture/raster_in_parts.h"
#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

double farthest_of(const Camera& camera, const Box& box) {
  double eye_z = 0;
  for (const glm::vec3& corner : box.corners())
    eye_z = std::max(eye_z, glm::dot(glm::dvec3(corner) - camera.position(), camera.forward()));
  return eye_z;
}

}  // namespace

Box RasterSource::bounds(std::span<const std::uint32_t> objects) const {
  return placed_.opaque_bounds(objects);
}

Result<CapturedPicture> RasterSource::capture(const CaptureRequest& request) {
  if (Result<> can = can_rasterize(request, name()); !can) return can.error();
  RILIEVO_EXPECTS(!(request.staggered && request.farthest));
  const Camera& camera = request.camera;
  std::span<const std::uint32_t> objects = request.objects;
  // Of many objects, as of a whole view, most are outside of a band of it.
  constexpr std::size_t kMany = 16;
  if (objects.empty() || (objects.size() > kMany && !request.farthest)) {
    visible_.clear();
    if (objects.empty())
      placed_.cull(camera, visible_);
    else
      placed_.cull(camera, objects, visible_);
    objects = visible_;
  }
  if (request.farthest)
    for (const std::uint32_t object : objects)
      if (farthest_of(camera, placed_.bounds()[object]) > camera.z_far)
        return Error{std::string(name()),
                     "the rasteriser needs a far plane behind all of the objects' surfaces"};
  CapturedPicture captured{rasterizer_.capture(camera, objects, placed_.poses(), request.samples,
                                               request.with_sky, request.staggered),
                           {}};
  captured.picture.name = name();
  if (!request.identifiers) captured.picture.object = {};
  if (request.farthest)
    captured.farthest = rasterizer_.capture_farthest(camera, objects, placed_.poses());
  bound_thin_texels(captured);
  return captured;
}

std::unique_ptr<PictureInParts> RasterSource::in_parts() {
  return std::make_unique<RasterInParts>(placed_, rasterizer_.materials());
}

}  // namespace rilievo

// Coarse pictures in little time: by rays, one sample per texel.
//
// Their time depends on the number of texels, hardly on that of triangles. Objects stand where they
// are at time 0: none of those that move may be captured.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo {

// Captures pictures of one scene by rays.
class CoarseCapture {
 public:
  // `scene` must be valid and outlive the object. Fails if memory does not suffice.
  [[nodiscard]] static Result<std::unique_ptr<CoarseCapture>> create(const Scene& scene);

  // Captures `objects` (not empty) for a frame whose pixels are `pixel` texels wide, as
  // PictureCaster::draw_coarse. Valid until the next call; null if memory does not suffice.
  [[nodiscard]] const RasterPicture* capture(const Camera& camera, float pixel,
                                             std::span<const std::uint32_t> objects) {
    // Rays that had to pass through all others, leaf by leaf, took twice as long.
    if (!rays_.keep_objects(objects)) return nullptr;
    caster_.draw_coarse(camera, pixel, picture_);
    pixel_ = pixel;
    return &picture_;
  }
  // The identifiers of the objects captured last, by this camera: a texel each, rows from the
  // bottom. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> capture_objects(const Camera& camera) {
    caster_.draw_coarse_objects(camera, pixel_, objects_);
    return objects_.object;
  }

 private:
  explicit CoarseCapture(RayScene rays) : rays_(std::move(rays)), caster_(rays_) {}

  RayScene rays_;
  PictureCaster caster_;
  float pixel_ = 1;
  RasterPicture picture_;
  ObjectPicture objects_;
};

}  // namespace rilievo

// How does one pixel's ray meet one picture of a layered impostor? Internal to `warp`.
//
// World space; rays start at the frame's eye.
#pragma once

#include <optional>

#include "rilievo/core/camera.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// The segment of a frame's ray that can meet the bounds: origin + t direction for t in [begin,
// end], t in eye_z of the frame. `middle`: of what of the ray lies within the bounds, of which a
// segment may be a part.
struct PixelRay {
  glm::dvec3 origin{0.0}, direction{0.0};
  double begin = 0, end = 0, middle = 0;
};
// Bounds, with room for rounding, which must not cut off what lies on a face.
class RayBounds {
 public:
  explicit RayBounds(const Box& bounds);
  // Keeps of a ray what lies within, and finds its middle; false if nothing does.
  [[nodiscard]] bool keep(PixelRay& ray) const;

 private:
  glm::dvec3 low_, high_;
};
// The ray of a raster position; none if it misses the bounds.
[[nodiscard]] std::optional<PixelRay> pixel_ray(const Box& bounds, const Camera& camera,
                                                const glm::dvec2& raster);

// How nearly a picture looks along a ray: the cosine between it and the picture's own ray through
// its middle, times the length of the ray's direction. Alike for each part of a ray.
[[nodiscard]] double looks_along(const Camera& picture, const PixelRay& ray);

// The height-field ray march of a ray through a picture's surface.
[[nodiscard]] SurfaceHit march_picture(const LayeredImpostor& impostor, int view,
                                       const PixelRay& ray);

}  // namespace rilievo

// How do rays draw whole frames, without OpenGL?
//
// Embree, instanced: one ray for each sample, in packets of neighbouring pixels. Time grows little
// with the number of triangles.
#pragma once

#include <memory>

#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/frame_renderer.h"

namespace rilievo {

// Casts frames of one scene.
class RayRenderer final : public FrameRenderer {
 public:
  // `scene` must be valid and outlive the object. Fails if memory does not suffice.
  [[nodiscard]] static Result<std::unique_ptr<RayRenderer>> create(const Scene& scene);

  Result<> set_time(double time) override;
  Result<> draw(const Camera& camera, int samples, RasterPicture& picture) override;
  Result<> draw_objects(const Camera& camera, ObjectPicture& picture) override;

 private:
  explicit RayRenderer(RayScene rays) : rays_(std::move(rays)), caster_(rays_) {}

  RayScene rays_;
  PictureCaster caster_;
};

}  // namespace rilievo

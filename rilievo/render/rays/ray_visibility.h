// How do rays find which triangle each sample of a frame shows?
//
// Embree, one ray for each sample, as the rasteriser has them: the same triangles but for samples
// on their edges. Time grows little with the number of triangles.
#pragma once

#include <memory>

#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/frame_visibility.h"

namespace rilievo {

// Casts the frames of one scene.
class RayVisibility final : public FrameVisibility {
 public:
  // `scene` must be valid and outlive the object. Fails if memory does not suffice.
  [[nodiscard]] static Result<std::unique_ptr<RayVisibility>> create(const Scene& scene);

  [[nodiscard]] const Scene& scene() const { return rays_.scene(); }

  // Rays hit whatever is in view: `objects` must name all of that, and nothing may fade.
  Result<> find_visible(const Camera& camera, int samples, const PlacedScene& placed,
                        std::span<const std::uint32_t> objects,
                        std::span<const CrossFade> fading) override;
  [[nodiscard]] const SampleBuffer& seen() const override { return caster_.seen(); }
  [[nodiscard]] std::span<const PlacedMesh> meshes() const override { return caster_.meshes(); }
  [[nodiscard]] PictureView view(const Camera& camera) override { return caster_.view(camera); }

 private:
  explicit RayVisibility(RayScene rays) : rays_(std::move(rays)), caster_(rays_) {}

  RayScene rays_;
  PictureCaster caster_;
};

}  // namespace rilievo

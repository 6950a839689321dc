// Rays as a source of pictures: Embree sees a scene, without OpenGL.
//
// Captures the scene at the time for which the rays were built. Cameras of all kinds, any objects,
// wherever they are. The same surfaces, depths, identifiers and shading as OpenGL's; blended parts
// are absent. Uses all cores; the result does not depend on the number of threads.
#pragma once

#include "rilievo/capture/capture_source.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// A scene in Embree as a capture source.
class RaySource final : public CaptureSource {
 public:
  // `rays` must outlive the source.
  explicit RaySource(const RayScene& rays) : rays_(rays) {}

  [[nodiscard]] std::string_view name() const override { return rays_.scene().name; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Fails for an invalid camera, for other numbers of samples than 1 and 4, and for the
  // sky behind a back-perspective camera.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  // By cast_layers(). Fails for a back-perspective camera.
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override;
  [[nodiscard]] const Scene* scene() const override { return &rays_.scene(); }

 private:
  const RayScene& rays_;
};

}  // namespace rilievo

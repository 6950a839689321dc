// How does a ray tracer serve as a software shader? (S5.8)
//
// A capture source with the library's materials, and shadows, reflections and refractions on top
// (trace_light.h). Progressive (refine_picture.h). Depths and objects are those of RaySource.
// Secondary rays see the whole scene, whatever objects are captured. Uses all cores; the picture
// depends neither on their number nor on who watches.
#pragma once

#include "rilievo/capture/capture_source.h"
#include "rilievo/capture/shaders/trace_light.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// A scene, ray-traced.
class RayTracer final : public CaptureSource {
 public:
  // `rays` must outlive the source. To see through glass, build it with RayParts::all.
  explicit RayTracer(const RayScene& rays, const TraceOptions& options = {})
      : rays_(rays), options_(options) {}

  [[nodiscard]] std::string_view name() const override { return rays_.scene().name; }
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  // Takes 1 to 4096 samples. Fails for an invalid camera, and with_sky. Obeys request.control.
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;
  // By cast_layers(); of blended parts, only those that bend light become samples. Fails for a
  // back-perspective camera.
  [[nodiscard]] Result<LayeredDepthImage> capture_layers(const LayersRequest& request) override;
  [[nodiscard]] const Scene* scene() const override { return &rays_.scene(); }

 private:
  const RayScene& rays_;
  TraceOptions options_;
};

}  // namespace rilievo

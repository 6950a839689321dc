// How does the ray tracer shade what bends by time? (S5.8)
//
// A capture source over a scene of its own, which it bends to each request's time (scene/bend.h)
// before it traces: a picture of another time builds the models that bend anew. Objects' own motion
// is the frame's: they are where they are at `placed`. Progressive, and as the RayTracer otherwise.
#pragma once

#include <memory>

#include "rilievo/capture/capture_source.h"
#include "rilievo/capture/shaders/trace_light.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/scene/bend.h"

namespace rilievo {

// A scene that bends, ray-traced.
class PosedTracer final : public CaptureSource {
 public:
  // `deformations` must outlive the source, and fit the scene; `bounds`: deformation_bounds().
  // Fails if memory does not suffice.
  [[nodiscard]] static Result<std::unique_ptr<PosedTracer>> create(
      const Scene& scene, const Deformations& deformations,
      std::span<const DeformationBounds> bounds, double placed, const TraceOptions& options = {});

  [[nodiscard]] std::string_view name() const override { return scene_.name; }
  // At all times.
  [[nodiscard]] Box bounds(std::span<const std::uint32_t> objects) const override;
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override;

 private:
  PosedTracer(const Scene& scene, const Deformations& deformations,
              std::span<const DeformationBounds> bounds, double placed,
              const TraceOptions& options);

  Scene scene_;
  const Deformations& deformations_;
  double time_ = 0;  // that the meshes are bent to
  TraceOptions options_;
  std::optional<RayScene> rays_;
  std::vector<int> meshes_;  // that bend
  std::vector<Box> bounds_;  // of each object, at all times
};

}  // namespace rilievo

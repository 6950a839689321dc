#include "rilievo/frame/software/software_backend.h"

#include <string>
#include <utility>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/core/expects.h"
#include "rilievo/frame/software/software_backend_target.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/keyframes/keyframe_painter.h"
#include "rilievo/nailboard/software/software_boards.h"
#include "rilievo/nailboard/software/software_pictures.h"
#include "rilievo/nailboard/software/software_store.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo {
namespace {

// Rays, and what captures with them.
class BakingRays final : public ForwardingSource {
 public:
  explicit BakingRays(RayScene rays)
      : ForwardingSource(casting_), rays_(std::move(rays)), casting_(rays_) {}

 private:
  RayScene rays_;
  RaySource casting_;
};

constexpr int kMostPixels = 16384;  // of a side, as SoftwareTarget's

}  // namespace

Result<std::unique_ptr<SoftwareBackend>> SoftwareBackend::create(const Scene& scene, int samples,
                                                                 const Deformations* deformations) {
  if (samples != 1 && samples != 4)
    return Error{"samples", "frames drawn without OpenGL have 1 or 4 samples a pixel"};
  return {std::make_unique<SoftwareBackend>(scene, samples, deformations)};
}

SoftwareBackend::SoftwareBackend(const Scene& scene, int samples, const Deformations* deformations)
    : given_(scene),
      deformations_(deformations),
      bent_(deformations && !deformations->meshes.empty() ? std::make_unique<Scene>(scene)
                                                          : nullptr),
      placed_(bent_ ? *bent_ : scene),
      samples_(samples) {
  RILIEVO_EXPECTS(samples == 1 || samples == 4);
}

void SoftwareBackend::set_time(double time) {
  placed_.set_time(time);
  if (!bent_ || time == bent_to_) return;
  bend(*deformations_, time, *bent_);
  bent_to_ = time;
  placed_.update_bounds();
}

Result<std::unique_ptr<CaptureSource>> SoftwareBackend::make_capture_source() {
  Result<RayScene> rays = RayScene::create(scene(), placed_.time());
  if (!rays) return rays.error();
  return {std::make_unique<BakingRays>(std::move(*rays))};
}

std::span<const DrawableRow> SoftwareBackend::drawables() const { return software_drawable_rows(); }

Result<std::unique_ptr<NailboardStore>> SoftwareBackend::make_store(
    const NailboardStoreOptions& options) {
  return make_software_store(placed_, options);
}

Result<std::unique_ptr<PrewarpedBoards>> SoftwareBackend::make_boards() {
  return {std::make_unique<SoftwareBoards>()};
}

Result<PictureSet> SoftwareBackend::make_pictures(std::span<const DepthImage> pictures,
                                                  DepthMode mode, int delta_bits) {
  return make_software_pictures(pictures, mode, delta_bits);
}

Result<std::unique_ptr<Backend>> SoftwareBackend::make_backend(const Scene& scene) const {
  return {std::make_unique<SoftwareBackend>(scene, samples_)};
}

Result<std::unique_ptr<FrameSource>> SoftwareBackend::make_frames(
    std::unique_ptr<FrameChooser> chooser) {
  return {std::make_unique<SoftwareFrames>(*this, std::move(chooser))};
}

Result<std::unique_ptr<KeyframePainter>> SoftwareBackend::make_keyframe_painter() {
  return {std::unique_ptr<KeyframePainter>()};
}

Result<std::unique_ptr<BackendTarget>> SoftwareBackend::make_target(int width, int height) const {
  if (width < 1 || height < 1 || width > kMostPixels || height > kMostPixels)
    return Error{"frame", "size " + std::to_string(width) + "x" + std::to_string(height) +
                              " is not between 1 and " + std::to_string(kMostPixels)};
  return {std::make_unique<SoftwareBackendTarget>()};
}

}  // namespace rilievo

#include "rilievo/nailboard/gl/nailboard_capture.h"

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/gl/context.h"
#include "rilievo/nailboard/raster_gaps.h"

namespace rilievo {

bool rasterizes(CaptureBy by, int samples) {
  if (by == CaptureBy::opengl || !PlacedRaster::can_sample(samples)) return false;
  return by == CaptureBy::rasterizer || gl::is_software();
}

Result<NailboardCapture> NailboardCapture::create(SceneRenderer& renderer, CaptureBy by,
                                                  AtlasOptions options, DepthMode mode) {
  std::unique_ptr<PlacedRaster> rasterizer;
  if (rilievo::rasterizes(by, options.samples)) {
    rasterizer = std::make_unique<PlacedRaster>(renderer.placed());
    options.capture_bytes = &PlacedRaster::bytes;
  }
  Result<std::unique_ptr<NailboardSet>> set = NailboardSet::create(options, mode);
  if (!set) return set.error();
  return NailboardCapture(renderer, options.samples, std::move(rasterizer), std::move(*set));
}

void NailboardCapture::capture(const Camera& camera, std::span<const std::uint32_t> objects,
                               const AtlasSlot& slot) {
  if (rasterizer_)
    atlas().write(slot, rasterizer_->draw(camera, objects, samples_));
  else
    atlas().capture(*renderer_, camera, objects, slot);
}

GapTable NailboardCapture::gaps(const Camera& camera, std::span<const std::uint32_t> objects) {
  if (rasterizer_)
    return raster_gaps(rasterizer_->picture(), rasterizer_->draw_farthest(camera, objects), camera);
  const Result<Image<float>> nearest = capture_nearest(*renderer_, camera, objects);
  const Result<Image<float>> farthest = capture_farthest(*renderer_, camera, objects);
  if (!nearest.ok() || !farthest.ok()) return unknown_gaps(camera);
  return make_gap_table(*nearest, *farthest);
}

}  // namespace rilievo

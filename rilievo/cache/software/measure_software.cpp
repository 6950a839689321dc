#include "rilievo/cache/software/measure_software.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "rilievo/cache/measure_costs.h"
#include "rilievo/capture/coarse_capture.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/nailboard/software/software_pictures.h"
#include "rilievo/nailboard/software/software_store.h"

namespace rilievo {
namespace {

class SoftwareMeasured final : public MeasuredFrames {
 public:
  SoftwareMeasured(const MeasuredScene& scene, PictureSet pictures)
      : frame_(scene.frame), backend_(scene.scene, 4) {
    auto chooser = std::make_unique<MeasuredChooser>(std::move(pictures));
    chooser_ = chooser.get();
    frames_ = std::make_unique<SoftwareFrames>(backend_, std::move(chooser));
  }
  Result<> draw(const MeasuredRun& objects, const MeasuredRun& pictures) override {
    chooser_->show(objects, pictures);
    return frames_->draw(frame_, 0);
  }

 private:
  Camera frame_;
  SoftwareBackend backend_;
  MeasuredChooser* chooser_ = nullptr;
  std::unique_ptr<SoftwareFrames> frames_;
};

// A texel of a coarse picture of all balls, written into the store.
double measure_rays(const MeasuredScene& scene, CoarseCapture& coarse, NailboardStore& store) {
  Camera camera = scene.frame;
  camera.width /= 2, camera.height /= 2;
  std::vector<std::uint32_t> objects(scene.heavy.count);
  std::iota(objects.begin(), objects.end(), scene.heavy.first);
  double least_ms = std::numeric_limits<double>::infinity();
  for (int run = 0; run < 4; ++run) {
    const Stopwatch watch;
    [[maybe_unused]] const bool room = store.allocate(0, camera.width, camera.height);
    const RasterPicture* picture = coarse.capture(camera, 0.5f, objects);
    RILIEVO_EXPECTS(room && picture);
    store.write(0, *picture, store.written_bits());
    least_ms = std::min(least_ms, watch.ms());
    store.free(0);
  }
  return 1e6 * least_ms / (double(camera.width) * camera.height);
}

}  // namespace

Result<PolygonTimes> measure_polygons_by_software() {
  const MeasuredScene scene = measured_scene();
  Result<PictureSet> pictures = make_software_pictures(std::span(scene.pictures).first(1));
  if (!pictures) return pictures.error();
  SoftwareMeasured frames(scene, std::move(*pictures));
  return measure_polygons(scene, frames);
}

Result<MachineCosts> measure_software() {
  const MeasuredScene scene = measured_scene();
  Result<PictureSet> pictures = make_software_pictures(scene.pictures);
  if (!pictures) return pictures.error();
  MachineCosts costs;
  SoftwareMeasured frames(scene, std::move(*pictures));
  const Result<DrawTimes> drawing = measure_drawing(scene, frames);
  if (!drawing) return drawing.error();
  costs.draw_software = *drawing;

  const PlacedScene placed(scene.scene);
  const Result<std::unique_ptr<NailboardStore>> store = make_software_store(placed, {});
  if (!store) return store.error();
  costs.capture_rasterizer = measure_captures(scene, **store);
  Result<std::unique_ptr<CoarseCapture>> coarse = CoarseCapture::create(scene.scene);
  if (!coarse) return coarse.error();
  costs.ray_texel_ns = rounded_ns(measure_rays(scene, **coarse, **store));
  return costs;
}

}  // namespace rilievo

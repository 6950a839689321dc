#include "bench/live_bench_scene.h"

#include <algorithm>
#include <vector>

#include "rilievo/capture/shaders/lit_source.h"
#include "rilievo/capture/shaders/ray_tracer.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/keyframes/make_keyframe.h"
#include "rilievo/measure/stats.h"
#include "rilievo/serve/live_picture.h"

namespace rilievo::bench {
namespace {

constexpr int kTracedTruth = 64;  // samples a pixel

Rgba8Image halved(const Rgba8Image& fine) {
  Rgba8Image color(fine.width() / 2, fine.height() / 2);
  for (int y = 0; y < color.height(); ++y)
    for (int x = 0; x < color.width(); ++x) {
      glm::ivec4 sum(2);
      for (int k = 0; k < 4; ++k) sum += glm::ivec4(fine(2 * x + k % 2, 2 * y + k / 2));
      color(x, y) = glm::u8vec4(sum / 4);
    }
  return color;
}

}  // namespace

struct TracedLight {
  RayScene all;  // with glass
  RaySource geometry;
  RayTracer tracer{all};
  LitSource lit{geometry, tracer, {}};

  TracedLight(RayScene with_glass, const RayScene& rays)
      : all(std::move(with_glass)), geometry(rays) {}
};

LiveBenchScene::LiveBenchScene(const Scene& of, CameraPath walk, const LiveSizes& sizes,
                               RayScene rays)
    : scene_(of),
      path_(std::move(walk)),
      sizes_(sizes),
      placed_(of),
      rays_(std::move(rays)),
      raster_(placed_, rays_) {}

LiveBenchScene::~LiveBenchScene() = default;

Result<std::unique_ptr<LiveBenchScene>> LiveBenchScene::create(const Scene& of, CameraPath walk,
                                                               const LiveSizes& sizes,
                                                               bool traced) {
  Result<RayScene> rays = RayScene::create(of);
  if (!rays) return rays.error();
  std::unique_ptr<LiveBenchScene> made(
      new LiveBenchScene(of, std::move(walk), sizes, std::move(*rays)));
  if (!traced) return made;
  Result<RayScene> all = RayScene::create(of, 0, RayParts::all);
  if (!all) return all.error();
  made->traced_ = std::make_unique<TracedLight>(std::move(*all), made->rays_);
  return made;
}

CaptureSource& LiveBenchScene::source() {
  return traced_ ? static_cast<CaptureSource&>(traced_->lit) : raster_;
}

CaptureSource& LiveBenchScene::quick() {
  return traced_ ? static_cast<CaptureSource&>(traced_->geometry) : raster_;
}

const Sky* LiveBenchScene::sky() const { return traced_ ? &scene_.sky : nullptr; }

LiveScene LiveBenchScene::shown() {
  LiveScene shown;
  shown.name = scene_.name, shown.bounds = raster_.bounds({});
  shown.start = camera(0), shown.sky = sky();
  return shown;
}

LiveWorldOptions LiveBenchScene::world_options() const {
  LiveWorldOptions options;
  options.work_s = work_s, options.coarse_work_s = coarse_work_s;
  return options;
}

Camera LiveBenchScene::camera(double seconds) const {
  return camera_at(path_, path_.keys.front().time + std::max(seconds, 0.0), sizes_.width,
                   sizes_.height);
}

DepthImage LiveBenchScene::drawn(const Camera& camera) {
  CaptureRequest request;
  request.camera = camera;
  request.with_sky = true;
  return std::move(raster_.capture(request)->picture);
}

const std::pair<Rgba8Image, Image<std::uint32_t>>& LiveBenchScene::truth(double now) {
  const auto found = true_frames_.find(now);
  if (found != true_frames_.end()) return found->second;
  const Camera frame = camera(now);
  Rgba8Image color;
  if (traced_) {
    LitSource finest(traced_->geometry, traced_->tracer, {.samples = kTracedTruth});
    KeyframeRequest request;
    request.camera = frame, request.whole_texels = true, request.sky = sky();
    color = opaque_colors(make_keyframe(finest, request)->color);
  } else {
    color = halved(srgb8_from_linear(drawn(supersampled(frame, 2)).color));
  }
  return true_frames_.emplace(now, std::pair(std::move(color), drawn(frame).object)).first->second;
}

void LiveBenchScene::find_work() {
  for (const bool fine : {true, false}) {
    std::vector<double> took;
    for (int i = 0; i < 7; ++i) {
      LivePictureOrder order;
      const Camera frame = camera(sizes_.seconds * i / 7);
      order.frame = frame_scale(frame), order.fine = fine, order.cell = 0.5, order.sky = sky();
      order.camera = keyframe_camera(frame, 1.25, fine ? 1 : 0.5);
      const BusyWatch busy;
      (void)make_live_picture(fine ? source() : quick(), order);
      took.push_back(0.5e-3 * busy.ms());
    }
    (fine ? work_s : coarse_work_s) = std::max(percentile(took, 0.5), 1e-6);
  }
}

}  // namespace rilievo::bench

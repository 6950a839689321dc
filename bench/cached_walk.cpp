#include "bench/cached_walk.h"

#include <memory>

#include "bench/drawn_by.h"
#include "bench/report.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/gl/opengl_target.h"

namespace rilievo::bench {

Result<std::vector<CachedWalk>> walk_cached(const BuiltinScene& builtin,
                                            std::span<const ImageCacheOptions> caches,
                                            const CachedWalkOptions& options) {
  Result<SceneRenderer> renderer = SceneRenderer::create(builtin.scene);
  if (!renderer) return renderer.error();
  Result<OpenGLTarget> target =
      OpenGLTarget::create(options.width, options.height, options.samples);
  if (!target) return target.error();
  const auto direct = polygon_drawer(builtin.scene, &*renderer, options.samples);
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (ImageCacheOptions cache : caches) {
    cache.samples = options.samples;
    Result<CachedFrames> made = make_cache(builtin.scene, &*renderer, cache);
    if (!made) return made.error();
    sources.push_back(std::move(made->frames));
  }

  const std::size_t count = sources.size();
  std::vector<CachedWalk> walks(count);
  std::vector<std::vector<double>> times(count);
  std::vector<Rightness> right(count);
  std::vector<double> direct_ms;
  for (int frame = 0; frame < options.frames; ++frame) {
    const double time = frame_time(builtin.path, frame);
    const WalkFrame at{camera_at(builtin.path, time, options.width, options.height), time};
    const bool compared =
        options.compare_every > 0 && frame % options.compare_every == options.compare_every - 1;
    Rgba8Image truth;
    if (compared) {
      const Result<double> ms = time_frame(*direct, *target, at);
      if (!ms) return ms.error();
      direct_ms.push_back(*ms);
      truth = target->color();
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Result<double> ms = time_frame(*sources[i], *target, at);
      if (!ms) return ms.error();
      const FrameStats& stats = sources[i]->stats();
      walks[i].captures += stats.captures;
      walks[i].bound_px = std::max(walks[i].bound_px, stats.bound_px.value_or(0));
      if (frame == 0)
        walks[i].first_frame_ms = *ms;
      else
        times[i].push_back(*ms);
      if (!compared) continue;
      right[i].add(truth, target->color());
    }
    if (options.progress) options.progress(frame + 1, options.frames);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!times[i].empty()) walks[i].frame_ms = summarize(times[i]);
    if (direct_ms.empty()) continue;
    walks[i].direct_ms_p50 = median_of(direct_ms);
    right[i].finish();
    walks[i].psnr_db = right[i].psnr, walks[i].ssim = right[i].ssim, walks[i].flip = right[i].flip;
  }
  return walks;
}

Result<CachedWalk> walk_memory_cache(const BuiltinScene& builtin, ImageCacheOptions cache,
                                     const CachedWalkOptions& options) {
  cache.samples = options.samples;
  const Result<CachedFrames> made = make_cache(builtin.scene, nullptr, cache);
  if (!made) return made.error();
  FrameSource& source = *made->frames;
  CachedWalk walk;
  std::vector<double> times, busy;
  for (int frame = 0; frame < options.frames; ++frame) {
    const double time = frame_time(builtin.path, frame);
    const Camera camera = camera_at(builtin.path, time, options.width, options.height);
    const BusyWatch processors;
    const Stopwatch watch;
    if (Result<> drawn = source.draw(camera, time); !drawn) return drawn.error();
    const double ms = watch.ms();
    walk.captures += source.stats().captures;
    walk.bound_px = std::max(walk.bound_px, source.stats().bound_px.value_or(0));
    if (frame == 0) walk.first_frame_ms = ms;
    if (frame == 0 && options.frames > 1) continue;
    times.push_back(ms);
    busy.push_back(processors.ms());
  }
  walk.frame_ms = summarize(times);
  walk.busy_ms_p50 = median_of(busy);
  return walk;
}

}  // namespace rilievo::bench

#include "bench/clock_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "bench/owned_frames.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/method/relief_impostors.h"

namespace rilievo::bench {

Result<ImpostorDrawer> impostor_drawer(const Scene& scene, SceneRenderer* renderer,
                                       ImpostorContent content,
                                       const ImpostorFramesOptions& options, int samples) {
  std::unique_ptr<Backend> backend = make_backend(scene, renderer, samples);
  backend->set_time(0.0);
  Result<ImpostorFrames> made = make_impostor_frames(*backend, std::move(content), options);
  if (!made) return made.error();
  return ImpostorDrawer{std::make_unique<OwnedFrames>(std::move(backend), std::move(made->frames)),
                        made->chooser};
}

namespace {

// `chooser`: of the impostor in `frames`; null: there is none.
Result<ClockWalk> walk_frames(const TracedScene& traced, FrameSource& frames,
                              ImpostorChooser* chooser, const ClockWalkOptions& options) {
  FrameSource* const sources[] = {&frames};
  const Result<DrawTargets> targets =
      DrawTargets::create(sources, options.width, options.height, options.samples);
  if (!targets) return targets.error();
  ClockWalk walk;
  const Stopwatch clock;
  double next_ms = 0;
  while (clock.ms() < 1e3 * options.seconds) {
    const Camera camera =
        orbit_camera(traced, options.turn * clock.ms() / 1e3, options.width, options.height);
    const Result<double> ms = time_frame(frames, *targets, {camera, 0});
    if (!ms) return ms.error();
    ++walk.frames;
    // The first frames compile shaders and make each thread's memory.
    if (walk.frames > 3) walk.frame_ms.push_back(*ms);
    const ImpostorFrame frame = chooser ? chooser->statuses()[0].frame : ImpostorFrame{};
    walk.shown += frame.board != nullptr;
    if (frame.latency_ms > 0) walk.latency_ms.push_back(frame.latency_ms);
    const double gone = clock.ms() / 1e3 / options.seconds;
    if (double(walk.kept.size()) + 1 <= gone * (options.kept + 1) &&
        int(walk.kept.size()) < options.kept)
      walk.kept.push_back({camera, frame.board ? *frame.board : Prewarped{},
                           options.last ? options.last() : std::nullopt});
    next_ms = std::max(next_ms + options.pace_ms, clock.ms());
    std::this_thread::sleep_for(
        std::chrono::microseconds(std::int64_t(1e3 * std::max(0.0, next_ms - clock.ms()))));
  }
  if (chooser) walk.stats = chooser->workers().stats();
  return walk;
}

}  // namespace

Result<ClockWalk> walk_by_clock(const TracedScene& traced, SceneRenderer* renderer,
                                ImpostorContent content, const ClockWalkOptions& options) {
  ImpostorFramesOptions with{.workers = options.workers, .background = true};
  with.workers.gives_way = true;
  with.workers.predict_s = 20;
  // It is to be judged.
  with.workers.limits.drop = 1e3, with.workers.limits.stale_px = 1e4;
  const Result<ImpostorDrawer> drawer =
      impostor_drawer(*traced.scene, renderer, std::move(content), with, options.samples);
  if (!drawer) return drawer.error();
  return walk_frames(traced, *drawer->frames, drawer->chooser, options);
}

Result<ClockWalk> walk_polygons_by_clock(const TracedScene& traced, SceneRenderer* renderer,
                                         const ClockWalkOptions& options) {
  const std::unique_ptr<FrameSource> frames =
      polygon_drawer(*traced.scene, renderer, options.samples);
  return walk_frames(traced, *frames, nullptr, options);
}

std::string latency_histogram(const std::vector<double>& ms) {
  std::string text;
  double from = 0;
  for (const double to : {50.0, 100.0, 200.0, 400.0, 800.0, 1600.0, 3200.0, 6400.0, 1e9}) {
    const auto count =
        std::count_if(ms.begin(), ms.end(), [&](double v) { return v >= from && v < to; });
    if (count > 0)
      text += fmt::format("{}{}{:.0f}: {}", text.empty() ? "" : ", ",
                          to < 1e8 ? "<" : ">=", to < 1e8 ? to : from, count);
    from = to;
  }
  return text.empty() ? "none" : text;
}

}  // namespace rilievo::bench

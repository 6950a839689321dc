// Frames that stay fast and right while what they show takes long to shade (S5.1, S5.7).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "bench/benches.h"
#include "bench/clock_walk.h"
#include "bench/impostor_judge.h"
#include "bench/report.h"
#include "bench/slow_source.h"
#include "bench/stale_parts.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {
namespace {

constexpr double kTurn = std::numbers::pi / 6;  // of the orbit, a second
constexpr int kFrameWidth = 1280, kFrameHeight = 720, kFrameSamples = 4;
constexpr int kWalkWidth = 640, kWalkHeight = 360;  // of the walks by the clock

// A texel a pixel: the default.
WorkerOptions worker_options() { return {}; }

std::string decibels(double db) { return fmt::format("{:.1f}", db); }

// --- Staleness: the same eye, shown by pictures of earlier ones.

Result<> staleness(const TracedScene& traced, const BenchOptions& bench, BenchReport& report) {
  ImpostorJudge judge(traced, kFrameWidth, kFrameHeight, kFrameSamples);
  Table table{
      "How right are pictures that are not fresh? " + traced.name,
      {"age ms", "turned by", "warped PSNR", "SSIM", "FLIP", "as one plane PSNR", "SSIM", "FLIP"},
      {}};
  Table pairs{"Two pictures, merged; " + traced.name,
              {"ms", "one, as old, PSNR", "with one twice as old",
               "in the middle of two so far apart", "SSIM", "FLIP"},
              {}};
  const int eyes = bench.quick ? 1 : 6;
  for (const double age : {0.0, 0.1, 0.5}) {
    std::vector<ImpostorQuality> warped, plane, behind, between;
    for (int i = 0; i < eyes; ++i) {
      const double angle = 2 * std::numbers::pi * i / eyes;
      const Camera now = orbit_camera(traced, angle, kFrameWidth, kFrameHeight);
      const auto shade_at = [&](double seconds) {
        return judge.shade(orbit_camera(traced, angle + kTurn * seconds, kFrameWidth, kFrameHeight),
                           worker_options());
      };
      const Result<DepthImage> picture = shade_at(-age);
      if (!picture) return picture.error();
      const Result<ImpostorQuality> a = judge.judge(warped_for(*picture, now.position()), now);
      if (!a) return a.error();
      warped.push_back(*a);
      if (i == 0)
        report.pictures.push_back(
            png_picture(fmt::format("warped, {:.0f} ms old", 1e3 * age), judge.drawn()));
      if (age > 0) {
        // Pictures that come every `age`, for the eye that was; and for the eye that will be, when
        // it is in the middle between two of them, the worst place.
        const Result<DepthImage> older = shade_at(-2 * age), half = shade_at(-0.5 * age),
                                 ahead = shade_at(0.5 * age);
        for (const auto* one : {&older, &half, &ahead})
          if (!*one) return one->error();
        const Result<ImpostorQuality> two =
            judge.judge(merged_for(*picture, *older, now.position()), now);
        if (!two) return two.error();
        behind.push_back(*two);
        const Result<ImpostorQuality> both =
            judge.judge(merged_for(*half, *ahead, now.position()), now);
        if (!both) return both.error();
        between.push_back(*both);
        if (i == 0)
          report.pictures.push_back(png_picture(
              fmt::format("between two pictures, {:.0f} ms apart", 1e3 * age), judge.drawn()));
      }
      const Result<ImpostorQuality> b = judge.judge(as_one_plane(*picture), now);
      if (!b) return b.error();
      plane.push_back(*b);
      if (i == 0)
        report.pictures.push_back(
            png_picture(fmt::format("as one plane, {:.0f} ms old", 1e3 * age), judge.drawn()));
      if (i == 0 && age == 0.5) report.pictures.push_back(png_picture("traced", judge.truth()));
    }
    const ImpostorQuality w = mean_quality(warped), p = mean_quality(plane);
    table.rows.push_back(
        {fmt::format("{:.0f}", 1e3 * age), fmt::format("{:.0f}", age * kTurn * 57.29578),
         decibels(w.psnr_db), fmt::format("{:.4f}", w.ssim), fmt::format("{:.4f}", w.flip),
         decibels(p.psnr_db), fmt::format("{:.4f}", p.ssim), fmt::format("{:.4f}", p.flip)});
    if (age > 0) {
      const ImpostorQuality last = mean_quality(behind), both = mean_quality(between);
      pairs.rows.push_back({fmt::format("{:.0f}", 1e3 * age), decibels(w.psnr_db),
                            decibels(last.psnr_db), decibels(both.psnr_db),
                            fmt::format("{:.4f}", both.ssim), fmt::format("{:.4f}", both.flip)});
      report.figures.emplace_back(fmt::format("psnr_db_between_{:.0f}ms", 1e3 * age), both.psnr_db);
    }
    const std::string suffix = age == 0 ? "fresh" : fmt::format("{:.0f}ms", 1e3 * age);
    report.figures.emplace_back("psnr_db_" + suffix, w.psnr_db);
    report.figures.emplace_back("psnr_db_plane_" + suffix, p.psnr_db);
  }
  report.tables.push_back(std::move(table));
  report.tables.push_back(std::move(pairs));
  return stale_parts(traced, judge, kTurn, eyes, worker_options(), report);
}

// --- S5.7: what a steady frame costs more, and how right the object is once it is refined.

Result<> steady(const TracedScene& traced, const BenchOptions& bench, BenchReport& report) {
  const Camera camera = orbit_camera(traced, 0.4, kFrameWidth, kFrameHeight);
  Scene without = *traced.scene;
  without.objects.erase(without.objects.begin() + std::ptrdiff_t(traced.object));
  const Result<std::unique_ptr<SceneRenderer>> all = make_renderer(*traced.scene, bench),
                                               rest = make_renderer(without, bench);
  if (!all || !rest) return all ? rest.error() : all.error();
  ImpostorContentOptions content;
  content.objects = {fmt::format("#{}", traced.object)};
  Result<ImpostorContent> made = make_impostor_content(*traced.scene, 0.0, content);
  if (!made) return made.error();
  Result<ImpostorDrawer> impostors = impostor_drawer(*traced.scene, all->get(), std::move(*made),
                                                     {.workers = worker_options()}, kFrameSamples);
  if (!impostors) return impostors.error();
  const std::unique_ptr<FrameSource> direct =
                                         polygon_drawer(*traced.scene, all->get(), kFrameSamples),
                                     direct_rest =
                                         polygon_drawer(without, rest->get(), kFrameSamples);
  FrameSource* const sources[] = {direct.get()};
  const Result<DrawTargets> targets =
      DrawTargets::create(sources, kFrameWidth, kFrameHeight, kFrameSamples);
  if (!targets) return targets.error();
  std::vector<double> with_ms, without_ms, polygons_ms;
  for (int i = 0; i < (bench.quick ? 4 : 60); ++i)
    for (auto& [source, ms] :
         {std::pair<FrameSource*, std::vector<double>*>{impostors->frames.get(), &with_ms},
          {direct_rest.get(), &without_ms},
          {direct.get(), &polygons_ms}}) {
      const Result<double> took = time_frame(*source, *targets, {camera, 0});
      if (!took) return took.error();
      if (i > 0) ms->push_back(*took);  // the first frame waits for the picture
    }
  const double ratio = median_of(with_ms) / median_of(without_ms);
  Table table{"A steady frame with one ray-traced object (S5.7), " + traced.name,
              {"frame", "p50 ms", "over the frame without the object"},
              {}};
  for (const auto& [name, ms] :
       {std::pair<const char*, const std::vector<double>*>{"without the object", &without_ms},
        {"with its impostor", &with_ms},
        {"with its polygons", &polygons_ms}})
    table.rows.push_back({name, fmt::format("{:.2f}", median_of(*ms)),
                          fmt::format("{:.3f}", median_of(*ms) / median_of(without_ms))});
  report.tables.push_back(std::move(table));
  report.figures.emplace_back("steady_over_without", ratio);
  report.figures.emplace_back("steady_over_polygons", median_of(with_ms) / median_of(polygons_ms));

  Table refined{"The object beside a full ray tracing of it, steady camera, " + traced.name,
                {"texels a pixel", "samples a texel", "PSNR", "SSIM", "FLIP"},
                {}};
  ImpostorJudge judge(traced, kFrameWidth, kFrameHeight, kFrameSamples);
  for (const double fine : {1.0, 2.0}) {
    WorkerOptions options = worker_options();
    options.texels_per_px = fine;
    options.samples = fine > 1 ? 1 : 4;
    const Result<DepthImage> picture = judge.shade(camera, options);
    if (!picture) return picture.error();
    const Result<ImpostorQuality> q = judge.judge(warped_for(*picture, camera.position()), camera);
    if (!q) return q.error();
    refined.rows.push_back({fmt::format("{:.0f}", fine), std::to_string(options.samples),
                            decibels(q->psnr_db), fmt::format("{:.4f}", q->ssim),
                            fmt::format("{:.4f}", q->flip)});
    report.figures.emplace_back(fmt::format("psnr_db_refined_{:.0f}x", fine), q->psnr_db);
  }
  report.tables.push_back(std::move(refined));
  return Done{};
}

// --- A walk by the clock, with a tracer that is slower and slower.

ClockWalkOptions walk_options(double seconds) {
  ClockWalkOptions walk;
  walk.seconds = seconds, walk.turn = kTurn;
  walk.width = kWalkWidth, walk.height = kWalkHeight, walk.samples = kFrameSamples;
  walk.workers = worker_options();
  return walk;
}

// With a tracer that is `factor` times as slow.
Result<ClockWalk> walk_with_slow_tracer(const TracedScene& traced, SceneRenderer* renderer,
                                        double factor, bool busy, double seconds) {
  ImpostorContentOptions options;
  options.objects = {fmt::format("#{}", traced.object)};
  Result<ImpostorContent> content = make_impostor_content(*traced.scene, 0.0, options);
  if (!content) return content.error();
  SlowSource slow(*content->shaders[0], factor, busy);
  content->sources[0] = std::make_unique<KeptSource>(slow, nullptr, KeptOptions{});
  ClockWalkOptions walk = walk_options(seconds);
  walk.last = [&] { return slow.last(); };
  return walk_by_clock(traced, renderer, std::move(*content), walk);
}

// The time of copying as much as is read and written for a board.
double copy_ms(std::size_t texels) {
  std::vector<char> from(7 * texels, 1), to(from.size());
  double best = 1e300;
  for (int i = 0; i < 50; ++i) {
    const Stopwatch watch;
    std::memcpy(to.data(), from.data(), to.size());
    best = std::min(best, watch.ms());
    from[std::size_t(i) % from.size()] = to[std::size_t(i) * 7 % to.size()];
  }
  return best;
}

Result<> slow_walks(const TracedScene& traced, const BenchOptions& bench, BenchReport& report) {
  const Result<std::unique_ptr<SceneRenderer>> renderer = make_renderer(*traced.scene, bench);
  if (!renderer) return renderer.error();
  ImpostorJudge judge(traced, kWalkWidth, kWalkHeight, kFrameSamples);
  Table table{"The tracer made slower; the eye turns by 30 degrees a second, " + traced.name,
              {"times slower", "by", "frames", "p50 ms", "p99 ms", "p99 / p50", "pictures",
               "coarse", "given up", "shown %", "PSNR", "one plane", "needed to shown, ms"},
              {}};
  const double seconds = bench.quick ? 1 : bench.full ? 30 : 8;
  // What the tracer and its worker are not to blame for.
  const Result<ClockWalk> polygons =
      walk_polygons_by_clock(traced, renderer->get(), walk_options(seconds));
  if (!polygons) return polygons.error();
  const Summary alone = summarize(polygons->frame_ms);
  table.rows.push_back({"no tracer: polygons", "", std::to_string(polygons->frames),
                        fmt::format("{:.1f}", alone.p50), fmt::format("{:.1f}", alone.p99),
                        fmt::format("{:.2f}", alone.p99 / alone.p50), "", "", "", "", "", "", ""});
  report.figures.emplace_back("p50_ms_polygons", alone.p50);
  report.figures.emplace_back("p99_over_p50_polygons", alone.p99 / alone.p50);
  for (const bool busy : {false, true})
    for (const double factor : {1.0, 10.0, 50.0}) {
      if (bench.quick && (busy || factor == 10)) continue;
      const Result<ClockWalk> walk =
          walk_with_slow_tracer(traced, renderer->get(), factor, busy, seconds);
      if (!walk) return walk.error();
      std::vector<ImpostorQuality> shown, plane;
      std::size_t texels = 0;
      for (const KeptFrame& kept : walk->kept) {
        if (!kept.board.color.empty()) {
          const Result<ImpostorQuality> q = judge.judge(kept.board, kept.camera);
          if (!q) return q.error();
          shown.push_back(*q);
          texels = kept.board.color.size();
        }
        if (kept.last) {
          const Result<ImpostorQuality> q = judge.judge(as_one_plane(*kept.last), kept.camera);
          if (!q) return q.error();
          plane.push_back(*q);
        }
      }
      const Summary ms = summarize(walk->frame_ms);
      const ImpostorQuality w = mean_quality(shown), p = mean_quality(plane);
      table.rows.push_back(
          {fmt::format("{:.0f}", factor), busy ? "work" : "sleep", std::to_string(walk->frames),
           fmt::format("{:.1f}", ms.p50), fmt::format("{:.1f}", ms.p99),
           fmt::format("{:.2f}", ms.p99 / ms.p50), std::to_string(walk->stats.pictures),
           std::to_string(walk->stats.coarse), std::to_string(walk->stats.cancelled),
           fmt::format("{:.0f}", 100.0 * walk->shown / std::max(1, walk->frames)),
           shown.empty() ? "-" : decibels(w.psnr_db), plane.empty() ? "-" : decibels(p.psnr_db),
           latency_histogram(walk->latency_ms)});
      const std::string suffix = fmt::format("slow{:.0f}{}", factor, busy ? "_busy" : "");
      report.figures.emplace_back("p50_ms_" + suffix, ms.p50);
      report.figures.emplace_back("p99_over_p50_" + suffix, ms.p99 / ms.p50);
      report.figures.emplace_back("psnr_db_" + suffix, w.psnr_db);
      report.figures.emplace_back("psnr_db_reprojection_" + suffix, p.psnr_db);
      if (factor == 1 && !busy && walk->stats.warps > 0 && texels > 0) {
        const double warp = walk->stats.warp_ms / double(walk->stats.warps);
        report.figures.emplace_back("warp_ms", warp);
        report.figures.emplace_back("warp_over_memcpy", warp / copy_ms(texels));
      }
    }
  report.tables.push_back(std::move(table));
  return Done{};
}

}  // namespace

Result<BenchReport> decoupling(const BenchOptions& options) {
  BenchReport report;
  const std::string name = options.scenes.empty() ? std::string("builtin:teapots?triangles=100000")
                                                  : options.scenes.front();
  const Result<TracedScene> traced = traced_scene(name);
  if (!traced) return traced.error();
  int done = 0;
  for (auto* part : {staleness, steady, slow_walks}) {
    if (options.progress) options.progress(done++, 3);
    if (Result<> measured = part(*traced, options, report); !measured) return measured.error();
  }
  report.notes = {
      fmt::format(
          "One object, ray-traced, among rasterised ones; {} x {} pixels, {} samples. PSNR, "
          "SSIM and FLIP of the object alone, over black, in the rectangle around it, against "
          "a ray tracing by the frame's own camera; of frames that show the impostor. As one "
          "plane: the last picture, moved by a homography.",
          kWalkWidth, kWalkHeight, kFrameSamples),
      fmt::format("Frames are drawn by {}, at most every {:.0f} ms; one worker, one thread that "
                  "warps, both "
                  "giving way to the frame. Needed to shown: from the first order of a picture to "
                  "the frame that shows one.",
                  draws_by_software(options) ? "software" : "OpenGL", ClockWalkOptions{}.pace_ms)};
  return report;
}

}  // namespace rilievo::bench

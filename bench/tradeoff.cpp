// Speed for an allowed error, and a cached frame as the scene grows.
//
// tradeoff: a walk through a forest of ten million triangles for allowed errors of 0.25, 0.5, 1 and
// 2 pixels: figures speedup_Epx, psnr_db_Epx, ssim_Epx, flip_Epx, frame_ms_p50_Epx,
// frame_ms_p99_Epx, bound_px_max_Epx, and direct_ms_p50, embree_ms.
//
// scaling: the cached walk's p50 from 10^5 to 10^8 triangles of the same forest, seen from the same
// path, by software and, if there is one, by OpenGL: figures software_ms_p50_N,
// software_busy_ms_p50_N (of processors), frame_ms_p50_N; software_growth_ratio,
// software_busy_growth_ratio and growth_ratio, the last over the first.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "bench/benches.h"
#include "bench/cached_walk.h"
#include "bench/timing.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo::bench {
namespace {

constexpr std::array kErrors = {0.25, 0.5, 1.0, 2.0};

// One frame of primary rays on all cores, diffuse shading, one ray a pixel.
Result<double> embree_ms(const BuiltinScene& builtin, const CachedWalkOptions& options) {
  const Result<RayScene> rays = RayScene::create(builtin.scene);
  if (!rays) return rays.error();
  const Camera camera = camera_at(builtin.path, 0, options.width, options.height);
  return median_ms(5, 0, [&] { static_cast<void>(cast_picture(*rays, camera)); });
}

Curve curve_of(std::string name, std::span<const CachedWalk> walks, double CachedWalk::*figure) {
  Curve curve{std::move(name), {}, {}};
  for (std::size_t i = 0; i < walks.size(); ++i) {
    curve.x.push_back(kErrors[i]);
    curve.y.push_back(walks[i].*figure);
  }
  return curve;
}

}  // namespace

Result<BenchReport> tradeoff(const BenchOptions& options) {
  const Result<BuiltinScene> built = make_builtin(
      options.quick ? "builtin:forest?triangles=100000" : "builtin:forest?triangles=10000000");
  if (!built) return built.error();
  CachedWalkOptions walk;
  walk.progress = options.progress;
  if (options.quick) walk.width = 160, walk.height = 90, walk.frames = 4, walk.compare_every = 2;
  std::vector<ImageCacheOptions> caches;
  for (const double error : kErrors) {
    ImageCacheOptions cache;
    cache.error_px = error;
    caches.push_back(cache);
  }
  const Result<std::vector<CachedWalk>> walks = walk_cached(*built, caches, walk);
  if (!walks) return walks.error();
  const Result<double> embree = embree_ms(*built, walk);
  if (!embree) return embree.error();

  BenchReport report;
  Table table{"What an allowed error buys and costs",
              {"error px", "p50 ms", "p99 ms", "speed-up", "PSNR dB", "SSIM", "FLIP", "bound px"},
              {}};
  Curve speed_up{"speed-up", {}, {}};
  const double direct = walks->front().direct_ms_p50;
  report.figures = {{"direct_ms_p50", direct}, {"embree_ms", *embree}};
  for (std::size_t i = 0; i < kErrors.size(); ++i) {
    const CachedWalk& w = (*walks)[i];
    const double faster = direct / w.frame_ms.p50;
    table.rows.push_back({fmt::format("{}", kErrors[i]), fmt::format("{:.1f}", w.frame_ms.p50),
                          fmt::format("{:.1f}", w.frame_ms.p99), fmt::format("{:.1f}", faster),
                          fmt::format("{:.2f}", w.psnr_db), fmt::format("{:.4f}", w.ssim),
                          fmt::format("{:.4f}", w.flip), fmt::format("{:.2f}", w.bound_px)});
    speed_up.x.push_back(kErrors[i]);
    speed_up.y.push_back(faster);
    const std::string suffix = fmt::format("_{}px", kErrors[i]);
    const std::pair<const char*, double> figures[] = {{"speedup", faster},
                                                      {"psnr_db", w.psnr_db},
                                                      {"ssim", w.ssim},
                                                      {"flip", w.flip},
                                                      {"bound_px_max", w.bound_px},
                                                      {"frame_ms_p50", w.frame_ms.p50},
                                                      {"frame_ms_p99", w.frame_ms.p99}};
    for (const auto& [name, value] : figures) report.figures.emplace_back(name + suffix, value);
  }
  report.tables = {std::move(table)};
  report.plots = {{"Speed-up over direct drawing",
                   "allowed error, pixels",
                   "times",
                   {speed_up},
                   true,
                   false,
                   true},
                  {"Likeness to direct drawing",
                   "allowed error, pixels",
                   "PSNR, dB",
                   {curve_of("PSNR", *walks, &CachedWalk::psnr_db)},
                   true,
                   false,
                   true},
                  {"Perceived difference",
                   "allowed error, pixels",
                   "FLIP",
                   {curve_of("FLIP", *walks, &CachedWalk::flip)},
                   true,
                   false,
                   true}};
  report.notes = {
      fmt::format(
          "{}, {} frames of {} x {}, {} samples a pixel everywhere; every {}th frame is drawn "
          "directly too. The first frame, which fills the cache, is not in the percentiles.",
          built->scene.name, walk.frames, walk.width, walk.height, walk.samples,
          walk.compare_every),
      "embree_ms: the same frame by primary rays on all cores, one ray a pixel, diffuse shading."};
  return report;
}

Result<BenchReport> scaling(const BenchOptions& options) {
  const std::vector<int> sizes =
      options.quick ? std::vector<int>{10'000, 100'000}
                    : std::vector<int>{100'000, 1'000'000, 10'000'000, 100'000'000};
  CachedWalkOptions walk;
  walk.compare_every = 0;
  if (options.quick) walk.width = 160, walk.height = 90, walk.frames = 4;
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  BenchReport report;
  if (context) report.machine.gl_renderer = gl::renderer_name();
  // Walks of one size differ by a tenth and more from run to run: all sizes in turn, and the
  // medians.
  const int rounds = options.quick ? 1 : 3;
  struct Walks {
    std::vector<double> p50, p99, first, busy;
    int captures = 0;  // the same in each round
    void add(const CachedWalk& one) {
      p50.push_back(one.frame_ms.p50), p99.push_back(one.frame_ms.p99);
      first.push_back(one.first_frame_ms), busy.push_back(one.busy_ms_p50);
      captures = one.captures;
    }
  };
  std::vector<Walks> software(sizes.size()), opengl(sizes.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const Result<BuiltinScene> built =
          make_builtin(fmt::format("builtin:forest?triangles={}", sizes[i]));
      if (!built) return built.error();
      const ImageCacheOptions cache;
      const Result<CachedWalk> in_memory = walk_memory_cache(*built, cache, walk);
      if (!in_memory) return in_memory.error();
      software[i].add(*in_memory);
      if (context) {
        const Result<std::vector<CachedWalk>> walks = walk_cached(*built, {&cache, 1}, walk);
        if (!walks) return walks.error();
        opengl[i].add(walks->front());
      }
      if (options.progress)
        options.progress(round * int(sizes.size()) + int(i) + 1, rounds * int(sizes.size()));
    }
  report.plots = {{"Cost of a cached frame", "triangles", "ms", {}, true, false, true}};
  const auto show = [&](const char* name, const std::vector<Walks>& walks, bool by_software) {
    Table table{fmt::format("The same walk through a growing forest, {}", name),
                {"triangles", "p50 ms", "of the rounds", "p99 ms", "first frame ms", "captures"},
                {}};
    if (by_software) table.columns.emplace_back("p50 of processors, ms");
    Curve curve{fmt::format("{}, p50", name), {}, {}};
    std::vector<double> busy;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const Walks& w = walks[i];
      const auto [least, most] = std::minmax_element(w.p50.begin(), w.p50.end());
      const double median = median_of(w.p50);
      busy.push_back(median_of(w.busy));
      table.rows.push_back({std::to_string(sizes[i]), fmt::format("{:.1f}", median),
                            fmt::format("{:.1f} to {:.1f}", *least, *most),
                            fmt::format("{:.1f}", median_of(w.p99)),
                            fmt::format("{:.0f}", median_of(w.first)), std::to_string(w.captures)});
      report.figures.emplace_back(
          fmt::format("{}_ms_p50_{}", by_software ? "software" : "frame", sizes[i]), median);
      curve.x.push_back(sizes[i]);
      curve.y.push_back(median);
      if (!by_software) continue;
      table.rows.back().push_back(fmt::format("{:.1f}", busy.back()));
      report.figures.emplace_back(fmt::format("software_busy_ms_p50_{}", sizes[i]), busy.back());
    }
    report.figures.emplace_back(by_software ? "software_growth_ratio" : "growth_ratio",
                                curve.y.back() / curve.y.front());
    if (by_software)
      report.figures.emplace_back("software_busy_growth_ratio", busy.back() / busy.front());
    report.tables.push_back(std::move(table));
    report.plots[0].curves.push_back(std::move(curve));
  };
  show("software", software, true);
  if (context) show("OpenGL", opengl, false);
  report.notes = {
      "A larger forest reaches farther on all sides of the same path; what stood near stays."};
  if (!context) report.notes.push_back("No OpenGL to compare with: " + context.error().message());
  return report;
}

}  // namespace rilievo::bench

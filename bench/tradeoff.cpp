#include "bench/tradeoff.h"

#include <fmt/format.h>

#include <array>

#include "bench/cached_walk.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/render/rays/cast_picture.h"

namespace rilievo::bench {
namespace {

constexpr std::array kErrors = {0.25, 0.5, 1.0, 2.0};

// One frame of primary rays on all cores, diffuse shading, one ray a pixel.
Result<double> embree_ms(const BuiltinScene& builtin, const CachedWalkOptions& options) {
  const Result<RayScene> rays = RayScene::create(builtin.scene);
  if (!rays) return rays.error();
  const Camera camera = camera_at(builtin.path, 0, options.width, options.height);
  std::vector<double> times;
  for (int i = 0; i < 5; ++i) {
    const Stopwatch watch;
    const DepthImage picture = cast_picture(*rays, camera);
    times.push_back(watch.ms());
  }
  return percentile(times, 0.5);
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
  const std::vector<int> sizes = options.quick
                                     ? std::vector<int>{10'000, 100'000}
                                     : std::vector<int>{100'000, 1'000'000, 10'000'000, 50'000'000};
  CachedWalkOptions walk;
  walk.compare_every = 0;
  if (options.quick) walk.width = 160, walk.height = 90, walk.frames = 4;
  // Walks of one size differ by a tenth and more from run to run: all sizes in turn, and the
  // medians.
  const int rounds = options.quick ? 1 : 3;
  std::vector<std::vector<double>> p50(sizes.size()), p99(sizes.size()), first(sizes.size());
  std::vector<int> captures(sizes.size());
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      const Result<BuiltinScene> built =
          make_builtin(fmt::format("builtin:forest?triangles={}", sizes[i]));
      if (!built) return built.error();
      const ImageCacheOptions cache;
      const Result<std::vector<CachedWalk>> walks = walk_cached(*built, {&cache, 1}, walk);
      if (!walks) return walks.error();
      p50[i].push_back(walks->front().frame_ms.p50);
      p99[i].push_back(walks->front().frame_ms.p99);
      first[i].push_back(walks->front().first_frame_ms);
      captures[i] = walks->front().captures;  // the same in each round
      if (options.progress)
        options.progress(round * int(sizes.size()) + int(i) + 1, rounds * int(sizes.size()));
    }
  BenchReport report;
  Table table{"The same walk through a growing forest",
              {"triangles", "p50 ms", "of the rounds", "p99 ms", "first frame ms", "captures"},
              {}};
  Curve curve{"cached, p50", {}, {}};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto [least, most] = std::minmax_element(p50[i].begin(), p50[i].end());
    const double median = percentile(p50[i], 0.5);
    table.rows.push_back({std::to_string(sizes[i]), fmt::format("{:.1f}", median),
                          fmt::format("{:.1f} to {:.1f}", *least, *most),
                          fmt::format("{:.1f}", percentile(p99[i], 0.5)),
                          fmt::format("{:.0f}", percentile(first[i], 0.5)),
                          std::to_string(captures[i])});
    report.figures.emplace_back(fmt::format("frame_ms_p50_{}", sizes[i]), median);
    curve.x.push_back(sizes[i]);
    curve.y.push_back(median);
  }
  report.figures.emplace_back("growth_ratio", curve.y.back() / curve.y.front());
  report.tables = {std::move(table)};
  report.plots = {{"Cost of a cached frame", "triangles", "ms", {curve}, true, false, true}};
  report.notes = {
      "A larger forest reaches farther on all sides of the same path; what stood near stays."};
  return report;
}

}  // namespace rilievo::bench

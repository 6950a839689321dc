// Scenes such as users have, the eye moving by the clock: the cache against every baseline.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>

#include "bench/benches.h"
#include "bench/drawn_by.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "rilievo/compare/real_time.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/measure/gap_width.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/report.h"
#include "rilievo/measure/stats.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/method/levels.h"
#include "rilievo/render/rays/ray_visibility.h"

namespace rilievo::bench {
namespace {

constexpr int kSamples = 4, kKept = 8;
// The promise counts pixels farther from a boundary than the bound of 1 px and 1.5 px more.
constexpr int kMargin = 3;
// The same by a frame's own bounds, which may exceed the limits under a budget of time.
int margin_of(const FrameStats& stats) {
  return int(std::ceil(std::max(stats.bound_px.value_or(0), stats.gap_px) + 1.5));
}
// A baseline that takes longer draws fewer of the frames, but at least three.
constexpr double kBaselineMs = 15000;

struct Baseline {
  const char* name;
  std::unique_ptr<FrameSource> source;
};

struct Figures {
  RealTimeWalk walk;
  std::vector<double> psnr_db;
  Visibility visibility;
  double wrong_most = 0, wrong_counted_most = 0, wrong_beyond_most = 0, gap_most = 0;
  int missing = 0;
  std::optional<double> opengl_p50_ms;  // of the cache drawn by OpenGL, where it is not
  std::vector<std::pair<std::string, double>> baseline_ms;  // medians
  std::vector<double> baseline_psnr_db;                     // means; of the first one, the truth: 0
};

struct RealRun {
  int width = 1280, height = 720;
  double seconds = 4;
  std::string draw;
  bool software = false;  // draws the cache's frames
  ImageCacheOptions cache;
};

// `renderer`: null without OpenGL. The first one is the truth: OpenGL's frames, or the
// rasteriser's. What processors draw does not pay for a way through OpenGL.
Result<std::vector<Baseline>> make_baselines(const Scene& scene, SceneRenderer* renderer,
                                             double error_px) {
  std::vector<Baseline> baselines;
  if (renderer) baselines.push_back({"direct", polygon_drawer(scene, renderer, kSamples)});
  baselines.push_back({"direct-raster", polygon_drawer(scene, nullptr, kSamples)});
  Result<std::unique_ptr<RayVisibility>> rays = RayVisibility::create(scene);
  if (!rays) return rays.error();
  baselines.push_back({"direct-rays", polygon_drawer(scene, nullptr, kSamples, std::move(*rays))});
  ObjectLevels levels = make_object_levels(scene);
  for (const bool by_opengl : {true, false}) {
    if (by_opengl && !renderer) continue;
    auto made = make_level_frames(*make_backend(scene, by_opengl ? renderer : nullptr, kSamples),
                                  levels, error_px);
    if (!made) return made.error();
    baselines.push_back({by_opengl ? "lod" : "lod-raster", std::move(*made)});
  }
  return baselines;
}

// Draws the frames that were kept by every baseline, and compares them with the first one's.
Result<> draw_baselines(std::vector<Baseline>& baselines, const DrawTargets& targets,
                        Figures& figures, BenchReport& report, const std::string& name) {
  const auto& kept = figures.walk.kept;
  std::vector<Rgba8Image> truths;
  for (Baseline& baseline : baselines) {
    std::vector<double> times;
    double spent = 0, psnr_sum = 0;
    const bool is_truth = &baseline == &baselines[0];
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const auto& [frame, drawn] = kept[i];
      if (!is_truth && times.size() >= 3 && spent > kBaselineMs) break;
      if (!is_truth) {
        Result<double> ms = time_frame(*baseline.source, targets, frame);
        if (!ms) return ms.error();
        times.push_back(*ms);
        spent += *ms;
        const Rgba8Image shown = targets.of(*baseline.source).color();
        psnr_sum += std::min(psnr_db(truths[i], shown), kMaxPsnrDb);
        continue;
      }
      Result<DrawnFrame> made = draw_frame(*baseline.source, targets, frame);
      if (!made) return made.error();
      times.push_back(made->frame_ms);
      truths.push_back(std::move(made->color));
      const Rgba8Image& truth = truths.back();
      figures.psnr_db.push_back(std::min(psnr_db(truth, drawn.color), kMaxPsnrDb));
      const Image<std::uint32_t>& objects = made->objects;
      const Visibility seen = compare_visibility(objects, drawn.objects);
      figures.wrong_most = std::max(figures.wrong_most, seen.wrong_share());
      figures.wrong_counted_most =
          std::max(figures.wrong_counted_most,
                   compare_visibility(objects, drawn.objects, kMargin).wrong_share());
      figures.wrong_beyond_most = std::max(
          figures.wrong_beyond_most,
          compare_visibility(objects, drawn.objects, margin_of(drawn.stats)).wrong_share());
      figures.gap_most =
          std::max(figures.gap_most, widest_gap_px(objects, made->eye_z, drawn.eye_z));
      figures.missing += count_missing_objects(objects, drawn.objects, kMargin);
      if (i + 1 != kept.size()) continue;
      report.pictures.push_back(jpeg_picture(name + ", direct", truth));
      report.pictures.push_back(jpeg_picture(name + ", cache", drawn.color));
    }
    figures.baseline_ms.emplace_back(baseline.name, median_of(times));
    figures.baseline_psnr_db.push_back(psnr_sum / double(times.size()));
  }
  return Done{};
}

void add_walk_row(const std::string& name, const Figures& f, Table& table, BenchReport& report) {
  const Summary ms = summarize(f.walk.frame_ms);
  const Summary psnr = summarize(f.psnr_db);
  const auto fastest =
      std::min_element(f.baseline_ms.begin(), f.baseline_ms.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  const double speedup = fastest->second / ms.p50;
  const FiguresOf figure(name, report);
  if (f.opengl_p50_ms) figure("opengl_p50_ms", *f.opengl_p50_ms);
  figure("p50_ms", ms.p50), figure("p99_ms", ms.p99), figure("max_ms", ms.max);
  figure("first_frame_ms", f.walk.first_frame_ms);
  if (f.walk.cut_ms) figure("cut_ms", *f.walk.cut_ms);
  if (f.walk.cut_fine_ms) figure("cut_fine_ms", *f.walk.cut_fine_ms);
  figure("frames", double(f.walk.frame_ms.size()));
  figure("psnr_db", psnr.mean), figure("psnr_db_min", psnr.min);
  figure("wrong_visibility_max", f.wrong_most);
  figure("wrong_counted_max", f.wrong_counted_most);
  figure("wrong_beyond_bounds_max", f.wrong_beyond_most);
  figure("missing_objects", f.missing);
  figure("over_bound_share", f.walk.over_bound_share);
  figure("bound_px", f.walk.bound_px);
  figure("gap_px", f.gap_most), figure("gap_bound_px", f.walk.gap_px);
  for (std::size_t i = 0; i < f.baseline_ms.size(); ++i) {
    const std::string& field = f.baseline_ms[i].first;
    figure(field + "_ms", f.baseline_ms[i].second);
    if (i > 0) figure(field + "_psnr_db", f.baseline_psnr_db[i]);
  }
  figure("speedup_over_fastest_direct", speedup);
  std::vector<std::string> row{name,
                               fmt::format("{}", f.walk.frame_ms.size()),
                               fmt::format("{:.0f}", f.walk.first_frame_ms),
                               fmt::format("{:.0f}", ms.p50),
                               fmt::format("{:.0f}", ms.p99),
                               f.walk.cut_ms ? fmt::format("{:.0f}", *f.walk.cut_ms) : "",
                               f.walk.cut_fine_ms ? fmt::format("{:.0f}", *f.walk.cut_fine_ms) : "",
                               fmt::format("{:.1f}", psnr.mean),
                               fmt::format("{:.3f}", 100 * f.wrong_most),
                               fmt::format("{:.3f}", 100 * f.wrong_counted_most),
                               fmt::format("{:.3f}", 100 * f.wrong_beyond_most),
                               std::to_string(f.missing),
                               fmt::format("{:.1f}", f.gap_most),
                               fmt::format("{:.1f}", 100 * f.walk.over_bound_share)};
  row.push_back(f.opengl_p50_ms ? fmt::format("{:.0f}", *f.opengl_p50_ms) : "");
  for (const auto& [baseline, median] : f.baseline_ms) row.push_back(fmt::format("{:.0f}", median));
  row.push_back(fmt::format("{:.1f}", f.baseline_psnr_db.back()));
  row.push_back(fmt::format("{:.2f}", speedup));
  row.push_back(fastest->first);
  table.rows.push_back(std::move(row));
}

Result<> measure_scene(const RealScene& real_scene, const RealRun& run, Table& table,
                       BenchReport& report, const std::function<void()>& walk_done) {
  Result<Scene> scene = real_scene.make();
  if (!scene) return scene.error();
  std::optional<SceneRenderer> opengl;
  if (run.draw != "software") {
    Result<SceneRenderer> made = SceneRenderer::create(*scene);
    if (!made) return made.error();
    opengl.emplace(std::move(*made));
  }
  SceneRenderer* renderer = opengl ? &*opengl : nullptr;
  Result<std::vector<Baseline>> baselines = make_baselines(*scene, renderer, run.cache.error_px);
  if (!baselines) return baselines.error();
  FrameSource* sources[] = {(*baselines)[0].source.get()};
  const Result<DrawTargets> own = DrawTargets::create(sources, run.width, run.height, kSamples);
  if (!own) return own.error();
  const DrawTargets& targets = *own;
  report.notes.push_back(fmt::format(
      "{}: {} objects, {:.1f} million triangles, {} textures.", real_scene.name,
      scene->objects.size(), double(count_triangles(*scene)) * 1e-6, scene->textures.size()));
  const bool automatic = run.draw == "automatic", software = run.software;
  report.notes.push_back(fmt::format("{}: the cache is drawn by {}.", real_scene.name,
                                     software ? "software" : "OpenGL"));
  for (const RealWalk& walk : real_scene.walks(*scene)) {
    const Result<CachedFrames> cache = make_cache(*scene, software ? nullptr : renderer, run.cache);
    if (!cache) return cache.error();
    // Whoever stands still finds every picture at hand.
    const CameraPath path = there_and_back(walk.path, kLongestWalk);
    const double start = path.keys.front().time;
    const auto at = [&](double seconds) {
      return WalkFrame{camera_at(path, start + seconds, run.width, run.height), seconds};
    };
    // Shaders are compiled, textures are read for the first time.
    for (Baseline& baseline : *baselines)
      if (Result<double> ms = time_frame(*baseline.source, targets, at(0)); !ms) return ms.error();
    RealTimeOptions options;
    options.seconds = run.seconds;
    options.kept = kKept;
    options.limits = {run.cache.error_px, gap_limit_px(run.cache.error_px, run.cache.gap_px)};
    options.cuts = cuts_of(path);
    Figures figures;
    Result<RealTimeWalk> walked = walk_in_real_time(*cache->frames, targets, at, options);
    if (!walked) return walked.error();
    figures.walk = std::move(*walked);
    if (software && automatic) {
      ImageCacheOptions by_opengl = run.cache;
      by_opengl.levels = false;  // it has none
      const Result<CachedFrames> other = make_cache(*scene, renderer, by_opengl);
      if (!other) return other.error();
      walked = walk_in_real_time(*other->frames, targets, at, options);
      if (!walked) return walked.error();
      figures.opengl_p50_ms = summarize(walked->frame_ms).p50;
    }
    const std::string name = real_scene.name + "-" + walk.name;
    if (Result<> drawn = draw_baselines(*baselines, targets, figures, report, name); !drawn)
      return drawn;
    add_walk_row(name, figures, table, report);
    walk_done();
  }
  return Done{};
}

}  // namespace

Result<BenchReport> real(const BenchOptions& options) {
  RealRun run;
  if (options.quick) run.width = 160, run.height = 90, run.seconds = 0.2;
  if (options.width > 0) run.width = options.width, run.height = options.height;
  run.draw = options.draw;
  run.software = draws_by_software(options);
  run.cache.samples = kSamples;
  run.cache.capture_ms = options.capture_ms;
  run.cache.late = options.late;
  run.cache.max_spike = options.max_spike;
  run.cache.levels = options.levels;
  run.cache.machine = options.machine;
  if (options.levels && !run.software)
    return Error{"--levels", "the cache draws levels of detail without OpenGL only"};
  const std::vector<RealScene> scenes = bench_scenes(options);
  BenchReport report;
  Table table{
      fmt::format("The cache in real time, {} x {}, {} samples{}", run.width, run.height, kSamples,
                  (run.cache.capture_ms > 0
                       ? fmt::format(", captures for {:g} ms a frame", run.cache.capture_ms)
                       : "") +
                      (run.cache.levels ? ", with levels of detail" : "")),
      {"walk", "frames", "first ms", "p50 ms", "p99 ms", "cut ms", "until fine ms", "PSNR dB",
       "wrong %", "counted wrong %", "beyond its bounds %", "missing", "gap px", "over bound %",
       "by OpenGL ms"},
      {}};
  const bool opengl = run.draw != "software";
  for (const char* name : {"direct", "direct-raster", "direct-rays", "lod", "lod-raster"})
    if (opengl || (std::string_view(name) != "direct" && std::string_view(name) != "lod"))
      table.columns.push_back(fmt::format("{} ms", name));
  for (const char* name : {"lod-raster dB", "speed-up", "over"}) table.columns.push_back(name);
  const Stopwatch watch;
  int done = 0;
  for (const RealScene& scene : scenes) {
    const auto walk_done = [&] {
      if (options.progress) options.progress(++done, int(3 * scenes.size()));
    };
    if (Result<> measured = measure_scene(scene, run, table, report, walk_done); !measured)
      return measured.error();
  }
  report.figures.emplace_back("seconds", watch.ms() / 1000);
  report.tables = {std::move(table)};
  report.notes.push_back(fmt::format(
      "The eye moves by the clock; times are of all frames after the first. PSNR (mean), wrong "
      "visibility (most) and missing objects are of {} frames spread evenly over the walk, against "
      "{}; baselines are medians of the same frames (at least three), lod at the same error "
      "in pixels, with its own PSNR. Wrong visibility is a share of the pixels that are farther "
      "than 1 px from a "
      "boundary; the promise counts those that are farther than the bound and 1.5 px, here {} px. "
      "Beyond its bounds are pixels that are farther than the frame's own bounds, of errors and of "
      "gaps, and 1.5 px.",
      kKept, opengl ? "OpenGL's" : "the rasteriser's", kMargin));
  report.notes.push_back(
      "gap_px is the widest strip, in the frames that were compared, that shows what lies behind a "
      "surface instead of it; gap_bound_px is the cache's own bound.");
  if (options.scenes.empty() && (options.quick || !std::getenv("RILIEVO_DATA")))
    report.notes.push_back(
        "RILIEVO_DATA names no folder: like scenes of built-in models with made textures.");
  return report;
}

}  // namespace rilievo::bench

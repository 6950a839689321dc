// The method auto beside all methods: its time over that of the best.
//
// Along walks through the scenes of bench/real_scenes.h, through built-in scenes, or through files
// with paths beside them. All methods draw the same frames in turn, so that each meets the same
// load.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>

#include "bench/benches.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/compare/reference_frames.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/keyframes/eye_prediction.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/popping.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/report.h"
#include "rilievo/measure/stats.h"
#include "rilievo/method/auto.h"
#include "rilievo/method/good_enough.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo::bench {
namespace {

constexpr int kSamples = 4, kReference = 36, kUsualFrames = 8;
constexpr std::size_t kAround = 8;  // frames
constexpr double kRefresh = 30;     // frames a second of the eye, however long they take
constexpr double kSeconds = 8;      // of a walk, unless asked for another length
constexpr int kPlaceFrames = 80;    // frames are compared with the truth once in so many
constexpr const char* kMethods[] = {"auto", "direct-raster", "direct-rays",
                                    "lod",  "cache",         "keyframes"};

constexpr std::size_t kCacheAt = 4;

struct Timed {
  std::string name;
  std::unique_ptr<SoftwareBackend> backend;
  std::unique_ptr<FrameSource> frames;
  std::vector<double> ms, busy_ms;  // of all frames after the first; busy: of all threads
  double prepare_ms = 0;            // before its first frame
  double first_ms = 0;
  std::vector<double> psnr_db;  // by place
  std::vector<bool> bounded;    // auto's, drawn by the cache: the error is as was asked for
  // It shows what was asked for at each place; in the mean of the places.
  bool good = true, good_in_mean = true;
  Summary summary, busy;

  [[nodiscard]] double mean_db() const {
    return std::accumulate(psnr_db.begin(), psnr_db.end(), 0.0) / double(psnr_db.size());
  }
};

// By the rule of method/good_enough.h, of frames of such PSNR.
bool is_good(double db, double direct_db, double cache_db, double allowed_db) {
  const double best_db = std::min(direct_db, kUnseenDb);
  return good_enough(best_db - db, best_db - cache_db, allowed_db);
}

// After so many frames a method whose median is so many times the least one's is drawn in one frame
// of so many: it is not the best. Not one whose frames follow from those before: the eye would be
// faster for it.
constexpr int kFramesOfAll = 24, kSeldom = 8;
constexpr double kFarFromBest = 3;
// Who prepares for so much longer than direct drawing before its first frame lets the user wait, as
// no other does.
constexpr double kAtOnceMs = 250;

std::vector<bool> drawn_seldom(const std::vector<Timed>& methods) {
  std::vector<double> medians;
  for (const Timed& one : methods) medians.push_back(summarize(one.ms).p50);
  const double least = *std::min_element(medians.begin(), medians.end());
  std::vector<bool> seldom;
  for (std::size_t k = 0; k < methods.size(); ++k)
    seldom.push_back(k > 0 && k != kCacheAt && methods[k].name != "keyframes" &&
                     medians[k] > kFarFromBest * least);
  return seldom;
}

struct AutoWalk {
  std::vector<Timed> methods;  // auto first
  std::map<std::string, int> drawn_by;
  int changes = 0;
  // Over the median of the frames around, the worst first frame of a method that another one drew
  // before; and its excess of change over the true frames' (measure/popping.h), beside that of
  // frames without a change. The same where the eye has jumped, so that all of the frame changes:
  // nobody sees a pop there.
  double change_ms = 0, change_pop = 0, cut_pop = 0, usual_pop = 0;
  std::size_t best = 0;          // by p50, of those that are good
  std::size_t best_in_mean = 0;  // of those that are good in the mean of the places
  double best_p99 = 0, best_busy_p50 = 0;
  double best_p99_at_once = 0;  // of those that begin at once

  [[nodiscard]] double regret_p50() const {
    return methods[0].summary.p50 / methods[best].summary.p50;
  }
  [[nodiscard]] double regret_p50_in_mean() const {
    return methods[0].summary.p50 / methods[best_in_mean].summary.p50;
  }
  [[nodiscard]] double regret_busy() const { return methods[0].busy.p50 / best_busy_p50; }
  [[nodiscard]] double regret_p99() const { return methods[0].summary.p99 / best_p99; }
  [[nodiscard]] double regret_p99_at_once() const {
    return methods[0].summary.p99 / best_p99_at_once;
  }
};

struct AutoRun {
  int width = 1280, height = 720, frames = int(kSeconds * kRefresh);
  MethodOptions method;
};

Result<std::vector<Timed>> make_all(const Scene& scene, const AutoRun& run) {
  std::vector<Timed> all;
  for (const char* name : kMethods) {
    Timed one;
    one.name = name;
    one.backend = std::make_unique<SoftwareBackend>(scene, kSamples);
    const Stopwatch watch;
    Result<Method> made = make_method(name, run.method, *one.backend);
    if (!made) return made.error();
    one.frames = std::move(made->frames);
    one.prepare_ms = watch.ms();
    all.push_back(std::move(one));
  }
  return {std::move(all)};
}

// How much more the frame changed than the true frames did, where it did most.
Result<double> pop_of(const Rgba8Image& last, const Rgba8Image& now, const WalkFrame& last_frame,
                      const WalkFrame& frame, ReferenceFrames& reference) {
  const Result<Rgba8Image> true_last = reference.frame(last_frame);
  if (!true_last) return true_last.error();
  const Result<Rgba8Image> true_now = reference.frame(frame);
  if (!true_now) return true_now.error();
  return largest_pop(flip_map(*true_last, *true_now), flip_map(last, now)).tile;
}

Result<AutoWalk> walk_by_all(const Scene& scene, const CameraPath& path, const AutoRun& run) {
  Result<std::vector<Timed>> made = make_all(scene, run);
  if (!made) return made.error();
  AutoWalk walk;
  walk.methods = std::move(*made);
  SoftwareBackend backend(scene, kSamples);
  const Result<Method> truth = make_method("direct-raster", {}, backend);
  if (!truth) return truth.error();
  ReferenceFrames reference(*truth->frames, kSamples, {.samples = kReference});
  const CameraPath endless = there_and_back(path, kLongestWalk);
  const double start = endless.keys.front().time;
  std::string last;
  Rgba8Image last_color;
  std::vector<std::size_t> change_frames;  // of Timed::ms
  EyePrediction eye;
  std::vector<std::size_t> order(walk.methods.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 rng(1);
  std::vector<bool> seldom(walk.methods.size(), false);
  const auto frame_at = [&](int i) {
    const double seconds = i / kRefresh;
    return WalkFrame{camera_at(endless, start + seconds, run.width, run.height), seconds};
  };
  for (int i = 0; i < run.frames; ++i) {
    const WalkFrame frame = frame_at(i);
    eye.follow(frame.camera);
    // In another order each time: what one leaves in the processor's caches, and what it still does
    // on other threads when its frame is drawn, must not always meet the same one.
    std::shuffle(order.begin(), order.end(), rng);
    if (i == kFramesOfAll) seldom = drawn_seldom(walk.methods);
    const bool judged = (i + 1) % std::min(kPlaceFrames, run.frames) == 0;
    for (const std::size_t k : order) {
      if (seldom[k] && !judged && i % kSeldom != 0) continue;
      Timed& one = walk.methods[k];
      const BusyWatch busy;
      const Result<double> ms = time_frame(*one.frames, DrawTargets(), frame);
      if (!ms) return ms.error();
      if (i > 0) one.busy_ms.push_back(busy.ms());
      (i == 0 ? one.first_ms : one.ms.emplace_back()) = *ms;
    }
    const FrameDecision& decision = walk.methods[0].frames->stats().decision;
    ++walk.drawn_by[std::string(decision.method)];
    const bool changed = i > 0 && decision.method != last;
    const bool usual = i > 0 && !changed && i % (run.frames / kUsualFrames + 1) == 0;
    walk.changes += changed;
    if (changed) change_frames.push_back(walk.methods[0].ms.size() - 1);
    const Rgba8Image& drawn = walk.methods[0].frames->software_target()->color();
    if (changed || usual) {
      const Result<double> pop = pop_of(last_color, drawn, frame_at(i - 1), frame, reference);
      if (!pop) return pop.error();
      double& most = !changed ? walk.usual_pop : eye.jumped() ? walk.cut_pop : walk.change_pop;
      most = std::max(most, *pop);
    }
    last = decision.method, last_color = drawn;
    if (!judged) continue;
    Result<Rgba8Image> color = reference.frame(frame);
    if (!color) return color.error();
    for (Timed& one : walk.methods) {
      const FrameStats& stats = one.frames->stats();
      one.psnr_db.push_back(
          std::min(psnr_db(*color, one.frames->software_target()->color()), kMaxPsnrDb));
      one.bounded.push_back(stats.decision.method == "cache" && stats.bound_px &&
                            *stats.bound_px <= run.method.error_px);
    }
  }
  for (const std::size_t changed : change_frames) {
    const std::vector<double>& ms = walk.methods[0].ms;
    const std::size_t first = changed - std::min(changed, kAround);
    const std::size_t end = std::min(changed + kAround + 1, ms.size());
    const double around = summarize(std::span(ms).subspan(first, end - first)).p50;
    walk.change_ms = std::max(walk.change_ms, ms[changed] / around);
  }
  const Timed &direct = walk.methods[1], &cache = walk.methods[kCacheAt];
  for (std::size_t k = 0; k < walk.methods.size(); ++k) {
    Timed& one = walk.methods[k];
    one.summary = summarize(one.ms), one.busy = summarize(one.busy_ms);
    const double allowed_db = run.method.loss_db;
    for (std::size_t i = 0; i < one.psnr_db.size(); ++i)
      one.good =
          one.good && (k == kCacheAt || one.bounded[i] ||
                       is_good(one.psnr_db[i], direct.psnr_db[i], cache.psnr_db[i], allowed_db));
    one.good_in_mean =
        k == kCacheAt || is_good(one.mean_db(), direct.mean_db(), cache.mean_db(), allowed_db);
    if (k > 0 && one.good_in_mean &&
        (walk.best_in_mean == 0 || one.summary.p50 < walk.methods[walk.best_in_mean].summary.p50))
      walk.best_in_mean = k;
    if (k == 0 || !one.good) continue;
    if (walk.best == 0 || one.summary.p50 < walk.methods[walk.best].summary.p50) walk.best = k;
    if (walk.best_busy_p50 == 0 || one.busy.p50 < walk.best_busy_p50)
      walk.best_busy_p50 = one.busy.p50;
    const auto least = [&](double& of) {
      if (of == 0 || one.summary.p99 < of) of = one.summary.p99;
    };
    least(walk.best_p99);
    if (one.prepare_ms <= direct.prepare_ms + kAtOnceMs) least(walk.best_p99_at_once);
  }
  return {std::move(walk)};
}

void add_walk(const std::string& name, const AutoWalk& walk, Table& table, BenchReport& report) {
  const FiguresOf figure(name, report);
  figure("regret_p50", walk.regret_p50()), figure("regret_p99", walk.regret_p99());
  figure("regret_p99_at_once", walk.regret_p99_at_once());
  figure("regret_busy_p50", walk.regret_busy());
  figure("regret_p50_in_mean", walk.regret_p50_in_mean());
  figure("good", walk.methods[0].good), figure("good_in_mean", walk.methods[0].good_in_mean);
  figure("changes", walk.changes), figure("change_over_p50", walk.change_ms);
  figure("change_pop", walk.change_pop), figure("usual_pop", walk.usual_pop);
  figure("cut_pop", walk.cut_pop);
  std::vector<std::string> row{name};
  for (const Timed& one : walk.methods) {
    const FiguresOf of_method(fmt::format("{}_{}", name, one.name), report);
    of_method("p50_ms", one.summary.p50), of_method("p99_ms", one.summary.p99);
    of_method("busy_p50_ms", one.busy.p50);
    of_method("prepare_ms", one.prepare_ms), of_method("first_ms", one.first_ms);
    of_method("psnr_db", one.mean_db());
    of_method("least_psnr_db", *std::min_element(one.psnr_db.begin(), one.psnr_db.end()));
    row.push_back(fmt::format("{:.1f}, {:.1f} ({:.0f}); {:.1f}{}", one.summary.p50, one.summary.p99,
                              one.busy.p50, one.mean_db(), one.good ? "" : "!"));
    if (one.prepare_ms > walk.methods[1].prepare_ms + kAtOnceMs)
      row.back() += fmt::format("; {:.1f} s before", 0.001 * one.prepare_ms);
  }
  row.push_back(walk.methods[walk.best].name);
  row.push_back(fmt::format("{:.3f} ({:.3f})", walk.regret_p50(), walk.regret_p50_in_mean()));
  row.push_back(fmt::format("{:.2f} ({:.2f})", walk.regret_p99(), walk.regret_p99_at_once()));
  row.push_back(fmt::format("{:.3f}", walk.regret_busy()));
  row.push_back(fmt::format("{}: {:.2f}, {:.3f} ({:.3f})", walk.changes, walk.change_ms,
                            walk.change_pop, walk.usual_pop));
  std::string drawn;
  for (const auto& [method, frames] : walk.drawn_by)
    drawn += fmt::format("{}{} {}", drawn.empty() ? "" : ", ", method, frames);
  row.push_back(drawn);
  table.rows.push_back(std::move(row));
}

}  // namespace

Result<BenchReport> automatic(const BenchOptions& options) {
  AutoRun run;
  if (options.quick) run.width = 160, run.height = 90, run.frames = 6;
  if (options.width > 0) run.width = options.width, run.height = options.height;
  if (options.seconds > 0) run.frames = int(std::ceil(options.seconds * kRefresh));
  run.method.by_clock = true;
  run.method.max_spike = options.max_spike;
  run.method.keyframe_samples = options.keyframe_samples;
  std::vector<RealScene> scenes;
  if (options.scenes.empty())
    for (const char* name : {"builtin:teapot", "builtin:teapots", "builtin:bridge"})
      if (!options.quick || scenes.empty()) scenes.push_back(builtin_scene(name));
  for (RealScene& one : bench_scenes(options)) scenes.push_back(std::move(one));
  BenchReport report;
  const double load = machine_load();
  Table table{
      fmt::format("auto beside all methods, {} x {}, {} samples: p50, p99 (busy p50) ms; PSNR dB",
                  run.width, run.height, kSamples),
      {"walk"},
      {}};
  for (const char* name : kMethods) table.columns.emplace_back(name);
  for (const char* name :
       {"best", "regret p50", "regret p99", "regret busy", "changes", "frames by"})
    table.columns.emplace_back(name);
  double worst_p50 = 0, worst_p99 = 0;
  int done = 0;
  for (const RealScene& real : scenes) {
    Result<Scene> scene = real.make();
    if (!scene) return scene.error();
    for (const RealWalk& one : real.walks(*scene)) {
      const Result<AutoWalk> walk = walk_by_all(*scene, one.path, run);
      if (!walk) return walk.error();
      add_walk(real.name + "-" + one.name, *walk, table, report);
      worst_p50 = std::max(worst_p50, walk->regret_p50());
      worst_p99 = std::max(worst_p99, walk->regret_p99());
    }
    if (options.progress) options.progress(++done, int(scenes.size()));
  }
  report.figures.emplace_back("worst_regret_p50", worst_p50);
  report.figures.emplace_back("worst_regret_p99", worst_p99);
  report.tables = {std::move(table)};
  report_load(load, report);
  report.notes.push_back(fmt::format(
      "All methods draw the same {} frames in turn, the eye moves by a thirtieth of a second a "
      "frame; times are of all frames after the first. PSNR against true frames of {} samples at "
      "each {}th frame. Regret is auto's p50 over the least of the others', and its p99 over their "
      "least (in brackets: of those that take at most {:g} ms more than direct-raster to prepare "
      "before their first frame; what is more is said); busy is the processor time of all threads, "
      "which other programs disturb less. "
      "Changes: their number, the worst first frame after one over the median of those around, and "
      "the most that "
      "such a frame changed beyond the true frames, FLIP in a tile (of {} frames without a "
      "change), but where the eye jumps. "
      "Methods count where they are, at each place (in brackets: in their mean), at most {:g} dB "
      "below direct-raster ({:.1f} dB at most), or "
      "no worse than the cache, whose error is at most 1 px, and at most {:g} dB below; ! says "
      "that they are not.",
      run.frames, kReference, std::min(kPlaceFrames, run.frames), kAtOnceMs, kUsualFrames,
      run.method.loss_db, kUnseenDb, kMostTimes * run.method.loss_db));
  return {std::move(report)};
}

}  // namespace rilievo::bench

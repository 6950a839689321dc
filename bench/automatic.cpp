// The method auto beside all methods: its time over that of the best.
//
// Along walks through the scenes of bench/real_scenes.h, through built-in scenes, or through files
// with paths beside them. All methods draw the same frames in turn, so that each meets the same
// load.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/automatic_walk.h"
#include "bench/benches.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "rilievo/measure/report.h"
#include "rilievo/method/good_enough.h"

namespace rilievo::bench {
namespace {

constexpr double kSeconds = 8;  // of a walk, unless asked for another length

void add_walk(const std::string& name, const AutoWalk& walk, Table& table, BenchReport& report) {
  const FiguresOf figure(name, report);
  figure("regret_p50", walk.regret_p50()), figure("regret_p99", walk.regret_p99());
  figure("regret_p99_at_once", walk.regret_p99_at_once());
  figure("regret_busy_p50", walk.regret_busy());
  figure("regret_p50_in_mean", walk.regret_p50_in_mean());
  figure("good", walk.methods[0].good()), figure("good_in_mean", walk.methods[0].good_in_mean);
  figure("changes", walk.changes), figure("change_over_p50", walk.change_ms);
  figure("change_pop", walk.change_pop), figure("usual_pop", walk.usual_pop);
  figure("cut_pop", walk.cut_pop);
  std::vector<std::string> row{name};
  for (const TimedMethod& one : walk.methods) {
    const FiguresOf of_method(fmt::format("{}_{}", name, one.name), report);
    of_method("p50_ms", one.summary.p50), of_method("p99_ms", one.summary.p99);
    of_method("busy_p50_ms", one.busy.p50);
    of_method("prepare_ms", one.prepare_ms), of_method("first_ms", one.first_ms);
    of_method("psnr_db", one.mean_db());
    of_method("least_psnr_db", *std::min_element(one.psnr_db.begin(), one.psnr_db.end()));
    of_method("bad_places", one.bad_places);
    row.push_back(fmt::format("{:.1f}, {:.1f} ({:.0f}); {:.1f}", one.summary.p50, one.summary.p99,
                              one.busy.p50, one.mean_db()));
    if (!one.good()) row.back() += fmt::format(" !{}", one.bad_places);
    if (one.prepare_ms > walk.methods[kDirectAt].prepare_ms + kAtOnceMs)
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
  run.frames = int(kSeconds * kAutoRefresh);
  if (options.quick) run.width = 160, run.height = 90, run.frames = 6;
  if (options.width > 0) run.width = options.width, run.height = options.height;
  if (options.seconds > 0) run.frames = std::max(int(std::ceil(options.seconds * kAutoRefresh)), 2);
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
                  run.width, run.height, kAutoSamples),
      {"walk"},
      {}};
  for (const char* name : kAutoMethods) table.columns.emplace_back(name);
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
      "no worse than the cache, whose error is at most 1 px, and at most {:g} dB below; ! says at "
      "how many places they are not.",
      run.frames, kAutoReference, run.place_frames(), kAtOnceMs, kUsualFrames, run.method.loss_db,
      kUnseenDb, kMostTimes * run.method.loss_db));
  return {std::move(report)};
}

}  // namespace rilievo::bench

// The cost and the quality of whole frames from keyframes, beside direct drawing.
//
// Walks in real time through the scenes of bench/real_scenes.h, or through files with paths beside
// them. Colours are compared with true frames of many samples a pixel, direct drawing's too.
#include <fmt/format.h>

#include <algorithm>

#include "bench/benches.h"
#include "bench/keyframe_walk.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "rilievo/capture/store/content_hash.h"
#include "rilievo/measure/report.h"

namespace rilievo::bench {
namespace {

void add_figures(const std::string& name, const KeyframeWalk& walk, BenchReport& report) {
  const FiguresOf figure(name, report);
  const KeyframeRival& rival = walk.fastest_as_good();
  figure("frames", walk.frames), figure("first_frame_ms", walk.first_frame_ms);
  figure("p50_ms", walk.frame_ms.p50), figure("p99_ms", walk.frame_ms.p99);
  figure("busy_p50_ms", walk.busy_p50_ms);
  figure("speedup_over_fastest_direct", rival.p50_ms / walk.frame_ms.p50);
  figure("busy_speedup_over_fastest_direct", rival.busy_p50_ms / walk.busy_p50_ms);
  figure("psnr_db", walk.psnr_db.mean), figure("psnr_db_min", walk.psnr_db.min);
  figure("psnr_db_direct", walk.rivals.front().psnr_db);
  figure("filled_share", walk.filled_share), figure("filled_share_max", walk.filled_share_max);
  figure("live_share", walk.live_share);
  figure("wrong_share", walk.wrong_share), figure("wrong_share_max", walk.wrong_share_max);
  figure("wrong_share_direct", walk.wrong_share_direct);
  figure("uncovered_share", walk.uncovered_share), figure("missing", walk.missing);
  figure("shimmer", walk.shimmer), figure("shimmer_direct", walk.rivals.front().shimmer);
  figure("keyframes", walk.keyframes), figure("coarse_keyframes", walk.coarse);
  figure("polygons_ms", walk.polygons_ms);
  figure("warp_ms", walk.warp_ms), figure("fill_ms", walk.fill_ms);
  figure("tiles_ms", walk.tiles_ms), figure("keyframe_ms", walk.keyframe_ms);
  figure("lost_at_edges", walk.lost_at_edges), figure("lost_as_wrong", walk.lost_as_wrong);
  for (const KeyframeRival& one : walk.rivals) {
    figure(one.name + "_ms", one.p50_ms), figure(one.name + "_busy_ms", one.busy_p50_ms);
    figure(one.name + "_psnr_db", one.psnr_db);
  }
}

void add_row(const std::string& name, const KeyframeWalk& walk, Table& table) {
  const KeyframeRival& rival = walk.fastest_as_good();
  std::vector<std::string> row{
      name, std::to_string(walk.frames), fmt::format("{:.1f}", walk.frame_ms.p50),
      fmt::format("{:.1f}", walk.frame_ms.p99), fmt::format("{:.1f}", walk.busy_p50_ms)};
  for (const KeyframeRival& one : walk.rivals)
    row.push_back(fmt::format("{:.0f} ({:.0f}), {:.1f}", one.p50_ms, one.busy_p50_ms, one.psnr_db));
  for (const double ratio :
       {rival.p50_ms / walk.frame_ms.p50, rival.busy_p50_ms / walk.busy_p50_ms})
    row.push_back(fmt::format("{:.2f}", ratio));
  row.push_back(rival.name);
  row.push_back(fmt::format("{:.1f}", walk.psnr_db.mean));
  for (const double share : {walk.filled_share, walk.live_share})
    row.push_back(fmt::format("{:.3f}", 100 * share));
  row.push_back(
      fmt::format("{:.3f} ({:.3f})", 100 * walk.wrong_share, 100 * walk.wrong_share_direct));
  row.push_back(std::to_string(walk.missing));
  row.push_back(fmt::format("{:.3f} ({:.3f})", 100 * walk.shimmer, 100 * walk.rivals[0].shimmer));
  table.rows.push_back(std::move(row));
}

Table make_table(const KeyframeWalkOptions& run) {
  Table table{fmt::format("Frames from keyframes {}, {} x {}, true frames of {} samples",
                          run.each_frame ? "sixty a second" : "in real time", run.width, run.height,
                          run.reference),
              {"walk", "frames", "p50 ms", "p99 ms", "busy ms"},
              {}};
  for (const char* name : {"direct-raster", "direct-rays", "lod", "cache"}) {
    if (run.each_frame && table.columns.size() > 5) break;
    table.columns.push_back(fmt::format("{} ms (busy), dB", name));
  }
  for (const char* name : {"speed-up", "busy", "over", "PSNR dB", "filled %", "live %",
                           "wrong % (direct)", "missing", "shimmer % (direct)"})
    table.columns.emplace_back(name);
  return table;
}

}  // namespace

Result<BenchReport> keyframes(const BenchOptions& options) {
  KeyframeWalkOptions run;
  if (options.quick)
    run.width = 160, run.height = 90, run.seconds = 0.2, run.places = 2, run.reference = 16;
  if (options.width > 0) run.width = options.width, run.height = options.height;
  run.keyframes.keyframes.keyframe_ms = options.keyframe_ms;
  run.keyframes.keyframes.samples = options.keyframe_samples;
  run.each_frame = options.each_frame;
  run.reference_folder = options.reference_folder;
  const std::vector<RealScene> scenes = bench_scenes(options);
  BenchReport report;
  const double load = machine_load();
  Table table = make_table(run);
  int done = 0;
  for (const RealScene& real : scenes) {
    Result<Scene> scene = real.make();
    if (!scene) return scene.error();
    if (!run.reference_folder.empty()) run.scene = content_hash(*scene);
    SoftwareBackend backend(*scene, run.keyframes.samples);
    for (const RealWalk& walk : real.walks(*scene)) {
      const std::string name = real.name + "-" + walk.name;
      const Result<KeyframeWalk> measured = walk_by_keyframes(backend, walk.path, run);
      if (!measured) return measured.error();
      add_figures(name, *measured, report);
      add_row(name, *measured, table);
      report.pictures.push_back(jpeg_picture(name + ", true", measured->truth));
      report.pictures.push_back(jpeg_picture(name, measured->shown));
      report.pictures.push_back(jpeg_picture(name + ", differences",
                                             difference_picture(measured->truth, measured->shown)));
    }
    if (options.progress) options.progress(++done, int(scenes.size()));
  }
  report.tables = {std::move(table)};
  report_load(load, report);
  report.notes.push_back(fmt::format(
      "The eye moves {} for {:g} s; times are of all frames after the first. Busy is the "
      "processor time of all threads, which other programs disturb less. Two frames that follow "
      "each other are compared at each of {} places: PSNR (mean) and shimmer (their change that "
      "the true frames do not have) with true frames of {} samples, wrong objects at pixels "
      "farther than 1 px from a boundary (in brackets direct drawing with samples a quarter of a "
      "pixel beside). The others draw the same frames; the cache walks by "
      "itself. A speed-up is over the fastest of those whose PSNR is not lower.",
      run.each_frame ? "by a sixtieth of a second a frame" : "by the clock", run.seconds,
      run.places, run.reference));
  return {std::move(report)};
}

}  // namespace rilievo::bench

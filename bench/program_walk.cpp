// A walk that goes on while another program renders its pictures (S5.8).
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "bench/benches.h"
#include "bench/clock_walk.h"
#include "bench/report.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {
namespace {

constexpr double kSlowTurn = 5 * std::numbers::pi / 180;  // of the orbit, a second: a slow walk
constexpr int kTexelSamples = 16;                         // of a picture and of the truth, a texel
constexpr int kPictureSize = 256;                         // of a picture, texels

// What the shader shows: an object of a small scene, a field in its place, or a program's scene.
struct Shown {
  TracedScene place;
  ImpostorContent content;
};

Result<Shown> show(const std::string& shader) {
  Result<TracedScene> place = traced_scene("builtin:teapots?triangles=10000");
  if (!place) return place.error();
  ImpostorContentOptions options;
  options.shader = shader;
  const bool runs = !program_named(shader).empty();
  if (!runs) options.objects = {fmt::format("#{}", place->object)};
  Result<ImpostorContent> content = make_impostor_content(*place->scene, 0.0, options);
  if (!content) return content.error();
  place->name = shader;
  if (runs) place->box = content->shaders[0]->bounds({});
  if (place->box.empty()) return Error{shader, "shows nothing"};
  return Shown{std::move(*place), std::move(*content)};
}

// The same shader again, for what is true: the first one's workers have it.
Result<ImpostorQuality> judge(const ClockWalk& walk, const std::string& shader,
                              const ClockWalkOptions& options, BenchReport& report,
                              double& truth_ms) {
  Result<Shown> again = show(shader);
  if (!again) return again.error();
  ImpostorJudge judge(again->place, options.width, options.height, options.samples);
  judge.judge_by(*again->content.shaders[0], again->content.impostors[0].shown.objects,
                 kTexelSamples);
  std::vector<ImpostorQuality> all;
  for (const KeptFrame& kept : walk.kept) {
    if (kept.board.color.empty()) continue;
    const Stopwatch watch;
    const Result<ImpostorQuality> one = judge.judge(kept.board, kept.camera);
    if (!one) return one.error();
    truth_ms += watch.ms();
    all.push_back(*one);
    report.pictures.push_back(
        png_picture(fmt::format("frame {}, shown", all.size()), judge.drawn()));
    report.pictures.push_back(
        png_picture(fmt::format("frame {}, by the shader itself", all.size()), judge.truth()));
  }
  if (all.empty()) return Error{shader, "finished no picture in time"};
  truth_ms /= double(all.size());
  return mean_quality(all);
}

}  // namespace

Result<BenchReport> program_walk(const BenchOptions& options) {
  const std::string shader = options.shader.empty() ? "raytrace" : options.shader;
  Result<Shown> shown = show(shader);
  if (!shown) return shown.error();
  const Result<std::unique_ptr<SceneRenderer>> renderer =
      make_renderer(*shown->place.scene, options);
  if (!renderer) return renderer.error();
  ClockWalkOptions walk_options;
  walk_options.seconds = options.quick ? 2 : options.full ? 60 : 20;
  walk_options.turn = kSlowTurn;
  walk_options.workers.size = kPictureSize, walk_options.workers.samples = kTexelSamples;
  const Result<ClockWalk> walk =
      walk_by_clock(shown->place, renderer->get(), std::move(shown->content), walk_options);
  if (!walk) return walk.error();
  BenchReport report;
  double truth_ms = 0;
  const Result<ImpostorQuality> quality = judge(*walk, shader, walk_options, report, truth_ms);
  if (!quality) return quality.error();
  const Summary ms = summarize(walk->frame_ms), latency = summarize(walk->latency_ms);
  report.figures = {{"p50_ms", ms.p50},
                    {"p99_ms", ms.p99},
                    {"frames", double(walk->frames)},
                    {"shown_share", double(walk->shown) / std::max(1, walk->frames)},
                    {"pictures", double(walk->stats.pictures)},
                    {"latency_p50_ms", latency.p50},
                    {"truth_ms", truth_ms},
                    {"psnr_db", quality->psnr_db},
                    {"ssim", quality->ssim},
                    {"flip", quality->flip}};
  report.tables.push_back(
      {"A walk while another one renders: " + shader,
       {"frames", "p50 ms", "p99 ms", "pictures", "shown %", "PSNR", "SSIM", "FLIP",
        "a frame by itself, ms", "needed to shown, ms"},
       {{std::to_string(walk->frames), fmt::format("{:.1f}", ms.p50), fmt::format("{:.1f}", ms.p99),
         std::to_string(walk->stats.pictures),
         fmt::format("{:.0f}", 100.0 * walk->shown / std::max(1, walk->frames)),
         fmt::format("{:.1f}", quality->psnr_db), fmt::format("{:.4f}", quality->ssim),
         fmt::format("{:.4f}", quality->flip), fmt::format("{:.0f}", truth_ms),
         latency_histogram(walk->latency_ms)}}});
  report.notes = {fmt::format(
      "The eye goes around by {:.0f} degrees a second, frames of {} x {} at most every {:.0f} ms, "
      "pictures of up to {} texels a side with {} samples. PSNR, SSIM and FLIP of what the frames "
      "showed, over black, against the shader's own picture by the frame's camera. Frames are "
      "drawn "
      "by {}.",
      kSlowTurn * 180 / std::numbers::pi, walk_options.width, walk_options.height,
      walk_options.pace_ms, kPictureSize, kTexelSamples, *renderer ? "OpenGL" : "software")};
  return report;
}

}  // namespace rilievo::bench

// What frames show while each keyframe takes seconds: a path tracer is the source.
//
// A walk by the clock through a scene that stands still (what moves is where it is at first), whose
// frames are compared with the source's own converged ones, beside two ways to show such a source
// without keyframes: its last complete frame as it is, and that frame on one plane, drawn for the
// eye (a time warp with a place). Both get the converged frame of an eye of some time ago, as if a
// source began a frame, took as long as a keyframe takes, and was shown until the next one was
// complete.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/benches.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "bench/traced_frame.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/compare/real_time.h"
#include "rilievo/core/idle_thread.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/measure/stats.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo::bench {
namespace {

constexpr double kSeconds = 16;
constexpr int kKept = 5, kTrueSide = 2;                // texels of a pixel, in each direction
constexpr int kTrueSamples = 4, kProgramSamples = 16;  // of these; programs are noisy

struct SlowWalk {
  RealTimeWalk walked;
  double seconds = 0;
  int keyframes_made = 0;
  double keyframe_s = 0;  // from one to the next
  Rightness keyframes, last, plane;
  Summary psnr_db;
  double age_s = 0;  // of the frames that others show, mean
  Rgba8Image truth, shown, by_plane;
};

// When was the frame begun that is shown at `now`, where each takes so long? Requires that one is
// complete.
double begun_at(double now, double takes) { return (std::floor(now / takes) - 1) * takes; }

Result<> compare_walk(const TracedFrames& traced, const std::function<WalkFrame(double)>& at,
                      const std::function<void()>& done, SlowWalk& walk) {
  std::vector<double> psnr;
  for (std::size_t i = 0; i < walk.walked.kept.size(); ++i) {
    const auto& [frame, shown] = walk.walked.kept[i];
    // The first frame of so many parts of the walk, or later by less than a frame.
    const double now = walk.seconds * double(i) / double(walk.walked.kept.size());
    if (now < walk.keyframe_s) continue;  // others show nothing
    const Result<TracedFrame> truth = traced.frame(frame.camera);
    if (!truth) return truth.error();
    const double begun = begun_at(now, walk.keyframe_s);
    const Result<TracedFrame> old = traced.frame(at(begun).camera);
    if (!old) return old.error();
    const Rgba8Image plane = draw_on_plane(*old, frame.camera);
    psnr.push_back(std::min(psnr_db(truth->color, shown.color), kMaxPsnrDb));
    walk.keyframes.add(truth->color, shown.color);
    walk.last.add(truth->color, old->color), walk.plane.add(truth->color, plane);
    walk.age_s += now - begun;
    walk.truth = truth->color, walk.shown = shown.color, walk.by_plane = plane;
    done();
  }
  if (psnr.empty())
    return Error{"slow-keyframes", "no keyframe was complete: walk for longer (--seconds)"};
  walk.age_s /= double(psnr.size());
  walk.keyframes.finish(), walk.last.finish(), walk.plane.finish();
  walk.psnr_db = summarize(psnr);
  return Done{};
}

// Counts the source's keyframes, not the coarse ones by rays.
class Counted final : public FrameSource {
 public:
  explicit Counted(std::unique_ptr<KeyframeFrames> frames) : frames_(std::move(frames)) {}
  Result<> draw(const Camera& camera, double time) override {
    Result<> drawn = frames_->draw(camera, time);
    keyframes += frames_->shares().completed;
    return drawn;
  }
  Result<> draw_objects() override { return frames_->draw_objects(); }
  [[nodiscard]] const SoftwareTarget* software_target() const override {
    return frames_->software_target();
  }
  [[nodiscard]] const FrameStats& stats() const override { return frames_->stats(); }

  int keyframes = 0;

 private:
  std::unique_ptr<KeyframeFrames> frames_;
};

// As the method does where frames go by the clock.
Result<std::unique_ptr<KeyframeFrames>> make_frames(const Scene& scene, const std::string& source,
                                                    int samples) {
  KeyframeFramesOptions options;
  options.keyframes.beside = true, options.keyframes.samples = samples;
  if (program_named(source).empty()) options.keyframes.sky = &scene.sky;
  return KeyframeFrames::create(
      scene,
      [&](const RayScene& rays) {
        ShaderInput input;
        input.rays = &rays, input.exec.world = scene.world, input.exec.nice = kIdleNice;
        return make_slow_source(source, input);
      },
      options);
}

Result<SlowWalk> walk_slowly(const Scene& scene, const TracedFrames& traced, const CameraPath& path,
                             const std::string& source, const BenchOptions& options, int width,
                             int height, const std::function<void()>& done) {
  Result<std::unique_ptr<KeyframeFrames>> frames =
      make_frames(scene, source, options.keyframe_samples);
  if (!frames) return frames.error();
  // Not after the walk: it would go on making the next keyframe beside the true frames.
  auto counted = std::make_unique<Counted>(*std::move(frames));
  const CameraPath endless = there_and_back(path, kLongestWalk);
  const auto at = [&](double seconds) {
    return WalkFrame{camera_at(endless, endless.keys.front().time + seconds, width, height), 0};
  };
  RealTimeOptions real_time;
  real_time.seconds = options.quick ? 2 : options.seconds > 0 ? options.seconds : kSeconds;
  real_time.kept = options.quick ? 2 : kKept;
  real_time.waits = true;
  Result<RealTimeWalk> walked = walk_in_real_time(*counted, {}, at, real_time);
  if (!walked) return walked.error();
  SlowWalk walk{.walked = std::move(*walked), .seconds = real_time.seconds};
  walk.keyframes_made = counted->keyframes;
  walk.keyframe_s = real_time.seconds / std::max(1, walk.keyframes_made);
  counted.reset();
  if (Result<> compared = compare_walk(traced, at, done, walk); !compared) return compared.error();
  return {std::move(walk)};
}

void add_figures(const std::string& name, const SlowWalk& walk, BenchReport& report, Table& table) {
  const FiguresOf figure(name, report);
  const Summary ms = summarize(walk.walked.frame_ms);
  figure("frames", double(walk.walked.frame_ms.size()));
  figure("first_frame_ms", walk.walked.first_frame_ms);
  figure("p50_ms", ms.p50), figure("p99_ms", ms.p99);
  figure("keyframes", walk.keyframes_made), figure("keyframe_s", walk.keyframe_s);
  figure("age_s", walk.age_s), figure("psnr_db_min", walk.psnr_db.min);
  std::vector<std::string> row{name,
                               std::to_string(walk.walked.frame_ms.size()),
                               fmt::format("{:.0f}", walk.walked.first_frame_ms),
                               fmt::format("{:.1f}, {:.1f}", ms.p50, ms.p99),
                               fmt::format("{:.1f}", walk.keyframe_s),
                               fmt::format("{:.1f}", walk.age_s)};
  const std::pair<const char*, const Rightness&> shown[] = {
      {"", walk.keyframes}, {"last_frame_", walk.last}, {"plane_", walk.plane}};
  for (const auto& [prefix, right] : shown) {
    figure(std::string(prefix) + "psnr_db", right.psnr);
    figure(std::string(prefix) + "ssim", right.ssim);
    figure(std::string(prefix) + "flip", right.flip);
    row.push_back(fmt::format("{:.1f}, {:.3f}, {:.3f}", right.psnr, right.ssim, right.flip));
  }
  table.rows.push_back(std::move(row));
}

}  // namespace

Result<BenchReport> slow_keyframes(const BenchOptions& options) {
  const int width = options.width > 0 ? options.width : options.quick ? 80 : 1280;
  const int height = options.width > 0 ? options.height : options.quick ? 45 : 720;
  const std::string by = options.source.empty() ? "raytrace" : options.source;
  if (!is_slow_source(by))
    return Error{"--source", by + " takes no time: raytrace or exec:PROGRAM"};
  const int true_samples = program_named(by).empty() ? kTrueSamples : kProgramSamples;
  const std::vector<RealScene> scenes = options.scenes.empty()
                                            ? std::vector{builtin_scene("builtin:teapots")}
                                            : bench_scenes(options);
  BenchReport report;
  const double load = machine_load();
  Table table{fmt::format("Keyframes by {}, {} x {}", by, width, height),
              {"walk", "frames", "first ms", "p50, p99 ms", "s for a keyframe", "age of a frame s",
               "keyframes: PSNR, SSIM, FLIP", "last frame", "on a plane"},
              {}};
  int done = 0;
  for (const RealScene& real : scenes) {
    const Result<Scene> scene = real.make();
    if (!scene) return scene.error();
    Result<TracedFrames> traced = TracedFrames::create(*scene, by, kTrueSide, true_samples);
    if (!traced) return traced.error();
    const std::vector<RealWalk> walks = real.walks(*scene);
    const int total = int(scenes.size() * walks.size()) * kKept;
    for (const RealWalk& walk : walks) {
      const std::string name = real.name + "-" + walk.name;
      const Result<SlowWalk> measured =
          walk_slowly(*scene, *traced, walk.path, by, options, width, height, [&] {
            if (options.progress) options.progress(++done, std::max(done, total));
          });
      if (!measured) return measured.error();
      add_figures(name, *measured, report, table);
      report.pictures.push_back(jpeg_picture(name + ", by the source", measured->truth));
      report.pictures.push_back(jpeg_picture(name + ", from keyframes", measured->shown));
      report.pictures.push_back(jpeg_picture(name + ", on a plane", measured->by_plane));
    }
  }
  report.tables = {std::move(table)};
  report_load(load, report);
  report.notes.push_back(fmt::format(
      "The eye moves by the clock; p50 and p99 are of all frames after the first. {} frames are "
      "compared with the source's own of {} samples a pixel (means). Last frame: such a one, "
      "begun so long ago as `age` says, where each takes as long as a keyframe and waits for the "
      "next one. On a plane: the same, drawn for the eye on a plane at its median depth.",
      options.quick ? 2 : kKept, kTrueSide * kTrueSide * true_samples));
  return {std::move(report)};
}

}  // namespace rilievo::bench

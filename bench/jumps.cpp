// What frames from keyframes show after the eye jumps, and after it turns round.
//
// Ten places of a walk: at each the eye arrives by a jump, stands, turns by 180 degrees in 0.3 s,
// and stands. By the clock; only drawing counts. Frames at some moments after each jump and each
// turn's beginning are compared with true ones.
#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/benches.h"
#include "bench/real_scenes.h"
#include "bench/report.h"
#include "bench/timing.h"
#include "rilievo/compare/reference_frames.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/report.h"
#include "rilievo/measure/stats.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/method/method.h"

namespace rilievo::bench {
namespace {

constexpr int kPlaces = 10;
constexpr double kTurnSeconds = 0.3, kHalfTurn = 3.14159265358979;
constexpr double kRefresh = 1.0 / 60;  // seconds: a display shows no more frames
// After an event, seconds.
constexpr double kMoments[] = {0, 0.1, 0.2, 0.3, 0.5, 0.75, 1, 1.5};

struct JumpOptions {
  int width = 1280, height = 720, places = kPlaces, reference = 16;
  double stands = 2;  // seconds
  KeyframeFramesOptions keyframes;
};

// A frame to be compared.
struct MomentFrame {
  std::size_t moment = 0;
  Camera camera;
  Rgba8Image color;
  Image<std::uint32_t> objects;
};

// A jump, or a turn.
struct Event {
  bool turn = false;
  double first_ms = 0, slowest_ms = 0;
  double fine_s = 0;  // until no coarse keyframe stood for a late one
  std::vector<MomentFrame> kept;
};

// What all events of one kind show.
struct EventFigures {
  double first_ms = 0, first_ms_max = 0, slowest_ms = 0, fine_s = 0, fine_s_max = 0;
  int missing = 0;
  std::vector<Summary> psnr;        // at each moment
  std::vector<double> psnr_direct;  // mean, at each moment
};

Camera turned(const Camera& camera, double angle) {
  Camera out = camera;
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), angle, glm::dvec3(0, 1, 0));
  for (int c = 0; c < 3; ++c) out.world_from_eye[c] = turn * camera.world_from_eye[c];
  return out;
}

Result<Event> draw_event(KeyframeFrames& frames, const Camera& place, bool turn,
                         const JumpOptions& options) {
  Event event;
  event.turn = turn;
  double now = 0;
  bool fine = false;
  for (bool first = true; now < options.stands || event.kept.size() < std::size(kMoments);
       first = false) {
    const double round = turn ? std::min(now / kTurnSeconds, 1.0) * kHalfTurn : 0;
    const Camera camera = turned(place, round);
    const Stopwatch watch;
    if (Result<> drawn = frames.draw(camera, 0); !drawn) return drawn.error();
    const double ms = watch.ms();
    if (first) event.first_ms = ms;
    event.slowest_ms = std::max(event.slowest_ms, ms);
    if (!fine) event.fine_s = now + ms * 1e-3;
    fine = frames.stats().late == 0;
    const std::size_t next = event.kept.size();
    if (next < std::size(kMoments) && now >= kMoments[next]) {
      // Reading it takes no time of the walk.
      if (Result<> drawn = frames.draw_objects(); !drawn) return drawn.error();
      const SoftwareTarget& target = *frames.software_target();
      event.kept.push_back({next, camera, target.color(), target.objects()});
    }
    now += std::max(ms * 1e-3, kRefresh);
  }
  return {std::move(event)};
}

Result<EventFigures> compare_events(const std::vector<Event>& events, bool turns,
                                    FrameSource& direct, ReferenceFrames& reference) {
  EventFigures figures;
  std::vector<std::vector<double>> psnr(std::size(kMoments));
  figures.psnr_direct.assign(std::size(kMoments), 0);
  int count = 0;
  for (const Event& event : events) {
    if (event.turn != turns) continue;
    ++count;
    figures.first_ms += event.first_ms, figures.fine_s += event.fine_s;
    figures.first_ms_max = std::max(figures.first_ms_max, event.first_ms);
    figures.slowest_ms = std::max(figures.slowest_ms, event.slowest_ms);
    figures.fine_s_max = std::max(figures.fine_s_max, event.fine_s);
    for (const MomentFrame& one : event.kept) {
      const WalkFrame frame{one.camera, 0};
      const Result<Rgba8Image> truth = reference.frame(frame);
      if (!truth) return truth.error();
      const Result<DrawnFrame> drawn = draw_frame(direct, DrawTargets(), frame);
      if (!drawn) return drawn.error();
      psnr[one.moment].push_back(std::min(psnr_db(*truth, one.color), kMaxPsnrDb));
      figures.psnr_direct[one.moment] += std::min(psnr_db(*truth, drawn->color), kMaxPsnrDb);
      figures.missing += count_missing_objects(drawn->objects, one.objects);
    }
  }
  figures.first_ms /= count, figures.fine_s /= count;
  for (double& mean : figures.psnr_direct) mean /= count;
  for (const std::vector<double>& one : psnr) figures.psnr.push_back(summarize(one));
  return {std::move(figures)};
}

void add_figures(const std::string& name, const EventFigures& figures, BenchReport& report,
                 Table& table, Plot& plot) {
  const FiguresOf figure(name, report);
  figure("first_ms", figures.first_ms), figure("first_ms_max", figures.first_ms_max);
  figure("slowest_ms", figures.slowest_ms);
  figure("fine_s", figures.fine_s), figure("fine_s_max", figures.fine_s_max);
  figure("missing", figures.missing);
  std::vector<std::string> row{
      name, fmt::format("{:.0f}, {:.0f}", figures.first_ms, figures.first_ms_max),
      fmt::format("{:.0f}", figures.slowest_ms),
      fmt::format("{:.2f}, {:.2f}", figures.fine_s, figures.fine_s_max),
      std::to_string(figures.missing)};
  Curve mean{name, {}, {}}, least{name + ", least", {}, {}}, direct{name + ", direct", {}, {}};
  for (std::size_t i = 0; i < std::size(kMoments); ++i) {
    const Summary& psnr = figures.psnr[i];
    figure(fmt::format("psnr_db_{:g}_s", kMoments[i]), psnr.mean);
    figure(fmt::format("psnr_db_min_{:g}_s", kMoments[i]), psnr.min);
    row.push_back(
        fmt::format("{:.1f}, {:.1f} ({:.1f})", psnr.mean, psnr.min, figures.psnr_direct[i]));
    for (Curve* curve : {&mean, &least, &direct}) curve->x.push_back(kMoments[i]);
    mean.y.push_back(psnr.mean), least.y.push_back(psnr.min);
    direct.y.push_back(figures.psnr_direct[i]);
  }
  table.rows.push_back(std::move(row));
  for (Curve* curve : {&mean, &least, &direct}) plot.curves.push_back(std::move(*curve));
}

Result<> add_scene(const std::string& name, const Scene& scene, const CameraPath& path,
                   const JumpOptions& options, BenchReport& report, Table& table) {
  Result<std::unique_ptr<KeyframeFrames>> frames = KeyframeFrames::create(scene, options.keyframes);
  if (!frames) return frames.error();
  const double start = path.keys.front().time, length = path.keys.back().time - start;
  // Neighbours of the walk are not neighbours here.
  const auto place = [&](int i) {
    const double at = (3 * i % options.places + 0.5) / options.places;
    return camera_at(path, start + at * length, options.width, options.height);
  };
  // What comes before the first jump.
  if (Result<> drawn = (*frames)->draw(turned(place(options.places - 1), 1), 0); !drawn)
    return drawn.error();
  std::vector<Event> events;
  for (int i = 0; i < options.places; ++i)
    for (const bool turn : {false, true}) {
      Result<Event> event = draw_event(**frames, place(i), turn, options);
      if (!event) return event.error();
      events.push_back(std::move(*event));
    }
  SoftwareBackend backend(scene, options.keyframes.samples);
  const Result<Method> direct = make_method("direct-raster", {}, backend);
  if (!direct) return direct.error();
  const Result<Method> true_frames = make_method("direct-raster", {}, backend);
  if (!true_frames) return true_frames.error();
  ReferenceFrames reference(*true_frames->frames, options.keyframes.samples,
                            {.samples = options.reference});
  Plot plot{name, "seconds after the jump, or the beginning of the turn", "PSNR, dB", {}};
  plot.points = true;
  for (const bool turns : {false, true}) {
    const Result<EventFigures> figures = compare_events(events, turns, *direct->frames, reference);
    if (!figures) return figures.error();
    add_figures(fmt::format("{}, {}", name, turns ? "turns" : "jumps"), *figures, report, table,
                plot);
  }
  report.plots.push_back(std::move(plot));
  for (const bool turns : {false, true})
    for (const Event& event : events)
      if (event.turn == turns) {
        for (const MomentFrame& one : event.kept)
          if (one.moment < 3)
            report.pictures.push_back(
                jpeg_picture(fmt::format("{}, {:g} s after a {}", name, kMoments[one.moment],
                                         turns ? "turn began" : "jump"),
                             one.color));
        break;
      }
  return Done{};
}

}  // namespace

Result<BenchReport> jumps(const BenchOptions& options) {
  JumpOptions run;
  if (options.quick) run.width = 160, run.height = 90, run.places = 2, run.stands = 0.1;
  if (options.width > 0) run.width = options.width, run.height = options.height;
  run.keyframes.keyframes.keyframe_ms = options.keyframe_ms;
  run.keyframes.keyframes.samples = options.keyframe_samples;
  const std::vector<RealScene> scenes = bench_scenes(options);
  BenchReport report;
  const double load = machine_load();
  Table table{fmt::format("After a jump, and after a turn by 180 degrees in {:g} s, {} x {}",
                          kTurnSeconds, run.width, run.height),
              {"walk", "first ms: mean, most", "slowest ms", "fine s: mean, most", "missing"},
              {}};
  for (const double moment : kMoments)
    table.columns.push_back(fmt::format("{:g} s: dB, least (direct)", moment));
  int done = 0;
  for (const RealScene& real : scenes) {
    Result<Scene> scene = real.make();
    if (!scene) return scene.error();
    const RealWalk walk = real.walks(*scene).front();
    if (Result<> added =
            add_scene(real.name + "-" + walk.name, *scene, walk.path, run, report, table);
        !added)
      return added.error();
    if (options.progress) options.progress(++done, int(scenes.size()));
  }
  report.tables = {std::move(table)};
  report_load(load, report);
  report.notes.push_back(fmt::format(
      "{} places, at each of which the eye arrives by a jump, stands, turns round and stands. True "
      "frames have {} samples a pixel. First is the frame with which the event begins; fine, when "
      "no coarse keyframe stands for a late one any more; missing, objects of which a compared "
      "frame shows nothing.",
      run.places, run.reference));
  return {std::move(report)};
}

}  // namespace rilievo::bench

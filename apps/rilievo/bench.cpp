// rilievo bench NAME: measures one thing, and says what came out.

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/commit.h"
#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/draw_speed.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/machine.h"
#include "apps/rilievo/method_options.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "bench/bench.h"
#include "rilievo/gl/context.h"
#include "rilievo/measure/bench_report.h"

namespace rilievo::app {
namespace {

struct BenchCommand {
  std::string name, json, html, capture, shader;
  std::vector<std::string> scenes;
  std::string draw = "automatic";
  bool quick = false, full = false;
  int width = 0, height = 0;
  double capture_ms = 0, late = SpikePolicy{}.late, max_spike = kInteractiveSpike;
  bool levels = false;
  bool each_frame = false;
  std::string reference_folder;
  double keyframe_ms = bench::BenchOptions{}.keyframe_ms;
  int keyframe_samples = bench::BenchOptions{}.keyframe_samples;
  double seconds = 0;
  int every_frame = 0;
  std::vector<double> latencies_ms;
  std::string source;
  std::optional<MachineCosts> machine;
};

const bench::Bench* find(const std::string& name) {
  for (const bench::Bench& one : bench::benches())
    if (one.name == name) return &one;
  return nullptr;
}

std::string known_benches() {
  std::string text;
  for (const bench::Bench& one : bench::benches())
    text += fmt::format("  {:<18}{}\n", one.name, one.question);
  return text;
}

// The frames of most benches, about, to choose who draws them.
constexpr double kTriangles = 1e6, kPixels = 1280 * 720;

// The context that the bench needs; null: none. Where `draw` leaves it open it becomes what is
// faster, or software where there is no OpenGL.
Result<std::unique_ptr<gl::Context>> open_opengl(const bench::Bench& bench, std::string& draw) {
  std::unique_ptr<gl::Context> none;
  const bool open = bench.needs == bench::Needs::as_it_draws;
  if (bench.needs == bench::Needs::nothing || (open && draw == "software")) return none;
  Result<std::unique_ptr<gl::Context>> made = gl::Context::create();
  if (made && open && draw == "automatic") {
    const Result<bool> software = software_is_faster(kTriangles, kPixels, {});
    if (!software) return software.error();
    draw = *software ? "software" : "opengl";
  }
  if (made) return made;
  if (open && draw == "automatic") {
    draw = "software";
    return none;
  }
  return Error{fmt::format("bench {}", bench.name),
               fmt::format("needs OpenGL, and there is none: {}", made.error().message())};
}

Result<> run_bench(const BenchCommand& options) {
  if (Result<> good = expect_outputs({options.json, options.html}); !good) return good;
  const bench::Bench& bench = *find(options.name);
  std::string draw = options.draw;
  const Result<std::unique_ptr<gl::Context>> context = open_opengl(bench, draw);
  if (!context) return context.error();
  Progress progress(options.name);
  bench::BenchOptions bench_options;
  bench_options.quick = options.quick;
  bench_options.full = options.full;
  bench_options.capture = options.capture;
  bench_options.scenes = options.scenes;
  bench_options.draw = draw;
  bench_options.width = options.width, bench_options.height = options.height;
  bench_options.capture_ms = options.capture_ms;
  bench_options.late = options.late;
  bench_options.max_spike = options.max_spike;
  bench_options.levels = options.levels;
  bench_options.machine = options.machine;
  bench_options.each_frame = options.each_frame;
  bench_options.reference_folder = options.reference_folder;
  bench_options.keyframe_ms = options.keyframe_ms;
  bench_options.keyframe_samples = options.keyframe_samples;
  bench_options.shader = options.shader;
  bench_options.seconds = options.seconds, bench_options.every_frame = options.every_frame;
  bench_options.latencies_ms = options.latencies_ms, bench_options.source = options.source;
  bench_options.progress = [&](int done, int total) { progress.show(done, total); };
  Result<BenchReport> report = bench.run(bench_options);
  if (!report) return report.error();
  progress.clear();
  report->bench = options.name;
  report->commit = commit();
  report->machine = this_machine();
  if (*context) report->machine.gl_renderer = gl::renderer_name();
  if (options.quick) report->notes.push_back("A quick run: the figures mean nothing.");
  if (!options.html.empty())
    if (Result<> done = write_text(options.html, bench_html(*report)); !done) return done;
  if (!options.json.empty())
    if (Result<> done = write_text(options.json, bench_json(*report)); !done) return done;
  if (options.json != "-") print_text(bench_text(*report));
  return Done{};
}

}  // namespace

Command bench_command(CLI::App& app) {
  auto options = std::make_shared<BenchCommand>();
  CLI::App* command = app.add_subcommand("bench", "Measure one thing");
  command->add_option("NAME", options->name, "What to measure")
      ->required()
      ->check([](const std::string& name) {
        return find(name) ? std::string()
                          : "no such bench; they are named by `rilievo bench --help`";
      });
  add_json_option(*command, options->json);
  command->add_option("--html", options->html, "Write a page with plots")->type_name("FILE");
  command
      ->add_option(
          "--capture", options->capture,
          "For rgbd: a folder of photographs with depth (transforms.json, trajectory.log or "
          "*.pose.txt)")
      ->type_name("DIR");
  command
      ->add_option("--shader", options->shader,
                   "For program-walk: raytrace, sdf:NAME, or exec:PROGRAM, which is started "
                   "(default raytrace)")
      ->type_name("SHADER");
  command
      ->add_option("--scene", options->scenes,
                   "For node-places: scenes besides stonehenge; for kinds: objects besides its "
                   "own; for real, keyframes, slow-keyframes, jumps, auto and serve: scenes "
                   "instead of its own, each with the "
                   "walks NAME-*.json beside it, builtin:NAME, or the name of one of its own")
      ->type_name("FILE ...");
  command
      ->add_option_function<std::string>(
          "--size",
          [options](const std::string& text) { parse_size(text, options->width, options->height); },
          "For real, keyframes, slow-keyframes, jumps and auto: size of a frame in pixels (default "
          "1280x720)")
      ->type_name("WxH");
  add_budget_options(*command, "For real", options->capture_ms, options->late, options->max_spike);
  command->add_flag(
      "--levels", options->levels,
      "For real: the cache draws levels of detail with bounded errors (not by OpenGL)");
  command
      ->add_option(
          "--keyframe-ms", options->keyframe_ms,
          "For keyframes and jumps: time that a frame spends on the next keyframe, in ms; 0: a "
          "sixteenth of one (default 8)")
      ->check(in_range(0.0, 1000.0))
      ->type_name("T");
  command
      ->add_option("--keyframe-samples", options->keyframe_samples,
                   "For keyframes and slow-keyframes: samples of a texel (default 4)")
      ->check(CLI::IsMember({1, 4, 16}));
  command->add_flag("--each-frame", options->each_frame,
                    "For keyframes: the eye moves by a sixtieth of a second a frame, however long "
                    "frames take; with --keyframe-ms 0, frames are the same on every machine");
  command
      ->add_option("--reference-folder", options->reference_folder,
                   "For keyframes: with --each-frame, where true frames are kept and found again")
      ->type_name("DIR");
  command
      ->add_option(
          "--seconds", options->seconds,
          "For serve, auto and slow-keyframes: length of a walk (default 8, serve with --full 60; "
          "slow-keyframes 16)")
      ->check(in_range(2.5, 100.0))
      ->type_name("T");
  command
      ->add_option("--every", options->every_frame,
                   "For serve: of 60 frames a second, compares one in so many (default 30, with "
                   "--full 120)")
      ->check(in_range(1, 6000))
      ->type_name("N");
  command
      ->add_option("--latency", options->latencies_ms,
                   "For serve: delays one way in ms, at 20 Mbit/s, instead of its own networks")
      ->check(in_range(0.0, 5000.0))
      ->type_name("MS ...");
  command
      ->add_option("--source", options->source,
                   "Who makes pictures: for serve raster (default) or raytrace, for slow-keyframes "
                   "raytrace (default) or exec:PROGRAM")
      ->type_name("SOURCE");
  add_machine_option(*command, "For real", options->machine);
  command
      ->add_option("--draw", options->draw,
                   "For real, decoupling, program-walk, pop and nailboard-bits: what draws frames: "
                   "opengl, software, or automatic: whichever is faster at polygons here, measured "
                   "first (default); real times OpenGL beside if there is one and software is not "
                   "asked for")
      ->check(CLI::IsMember({"opengl", "software", "automatic"}));
  command->add_flag("--quick", options->quick,
                    "Few cases only: a test that the benchmark runs, not a measurement");
  command
      ->add_flag("--full", options->full,
                 "All cases, for benches that otherwise try a part of them")
      ->excludes("--quick");
  command->footer("Benches:\n" + known_benches() +
                  "Example: rilievo bench nailboard-error --json -");
  return {command, [options](const std::string&) { return run_bench(*options); }};
}

}  // namespace rilievo::app

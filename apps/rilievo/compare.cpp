// rilievo compare SCENE --methods a,b,c -o DIR: draws a walk by each method and directly, and
// reports how fast and how right each was. What was baked into a file against the scene that it was
// baked of: rilievo compare FILE.exr --scene SCENE -o DIR.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/commit.h"
#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/methods.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/picture_file.h"
#include "apps/rilievo/program_scene.h"
#include "apps/rilievo/progress.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/cache/plan/policy.h"
#include "rilievo/capture/store/content_hash.h"
#include "rilievo/compare/compare.h"
#include "rilievo/compare/drawn_error.h"
#include "rilievo/gl/context.h"
#include "rilievo/io/png.h"
#include "rilievo/measure/report_summary.h"
#include "rilievo/scene/position_colors.h"

namespace rilievo::app {
namespace {

struct CompareCommand {
  // `file`: what was baked, if it is not the scene itself that is drawn.
  std::string scene, file, output, json, command_line;
  FileLimits limits;
  std::vector<std::string> methods;
  std::vector<std::string> foreign;  // NAME=FOLDER
  FrameOptions frames;
  MethodOptions method_options;
  bool pop = false, real_time = false, drawn_error = false, one_sample = false;
  int reference = 0;  // samples of a pixel of the true frames; 0: the first method's
  std::string reference_folder;
  WorldSpace baked;  // of `file`
};

// Direct drawing is always there, and first: it draws the true frames. Without OpenGL, and where
// something bends by time, the rasteriser does; with it, OpenGL, even where it runs on processors.
std::vector<std::string> with_direct(const std::vector<std::string>& methods, bool raster) {
  std::vector<std::string> all{raster ? "direct-raster" : "direct"};
  for (const std::string& method : methods)
    if (std::find(all.begin(), all.end(), method) == all.end()) all.push_back(method);
  return all;
}

void print_summary(const Report& report) {
  print("{:<16}{:>9}{:>9}{:>9}{:>8}{:>8}{:>8}{:>8}{:>10}{:>9}{:>11}{:>11}{:>9}\n", "method",
        "p50 ms", "p99 ms", "PSNR dB", "least", "SSIM", "FLIP", "99 %", "wrong %", "ghost %",
        "speckle %", "flicker %", "captures");
  for (const MethodResult& method : report.methods) {
    const MethodSummary s = summarize(method);
    print(
        "{:<16}{:>9.2f}{:>9.2f}{:>9.2f}{:>8.2f}{:>8.4f}{:>8.4f}{:>8.4f}{:>10.4f}{:>9.3g}{:>11.3g}{:"
        ">11.3g}{:>9}\n",
        method.name, s.frame_ms.p50, s.frame_ms.p99, s.psnr_db.mean, s.psnr_db.min, s.ssim.mean,
        s.flip.mean, s.flip_p99.mean, 100 * s.wrong_visibility.mean, 100 * s.ghost.mean,
        100 * s.speckle.mean, 100 * s.flicker.mean, method.captures);
  }
}

// A frame that another program drew.
Result<DrawnFrame> read_foreign(const std::filesystem::path& folder, int frame, int width,
                                int height) {
  const auto load = [&](const std::filesystem::path& path) -> Result<Rgba8Image> {
    Result<Rgba8Image> picture = load_png(path);
    if (picture && (picture->width() != width || picture->height() != height))
      return Error{path.string(), fmt::format("has {} x {} pixels instead of {} x {}",
                                              picture->width(), picture->height(), width, height)};
    return picture;
  };
  DrawnFrame drawn;
  Result<Rgba8Image> color = load(folder / fmt::format("frame_{:05}.png", frame));
  if (!color) return color.error();
  drawn.color = std::move(*color);
  const std::filesystem::path objects = folder / fmt::format("objects_{:05}.png", frame);
  if (!std::filesystem::exists(objects)) return drawn;
  const Result<Rgba8Image> codes = load(objects);
  if (!codes) return codes.error();
  drawn.objects = Image<std::uint32_t>(width, height);
  std::ranges::transform(codes->texels(), drawn.objects.texels().begin(), [](const glm::u8vec4& c) {
    return std::uint32_t(c.r) | std::uint32_t(c.g) << 8 | std::uint32_t(c.b) << 16;
  });
  return drawn;
}

// Direct drawing without antialiasing: what aliasing alone does to the figures.
constexpr char kOneSample[] = "direct-1-sample";

// What draws the scene, with the frames' samples and with one.
struct Stages {
  Stages(const Scene& scene, int samples, const Deformations* deformations = nullptr)
      : all(scene, samples, deformations), one_sample(scene, 1, deformations) {}
  Stage all, one_sample;
};

Result<Method> make_one(const std::string& method, const CompareCommand& options, Stages& stages) {
  if (method == kOneSample) {
    MethodOptions software = options.method_options;
    software.draw = "software";
    return stages.one_sample.make("direct-raster", software);
  }
  if (options.file.empty() || !kind_method(method).kind)
    return stages.all.make(method, options.method_options);
  Result<PictureFileContent> content = open_representation(options.file);
  if (!content) return content.error();
  return stages.all.make(method, options.method_options, std::move(content->representation));
}

// What draws each method; what the file holds, if there is one, is what they draw. Errors name the
// method: there are several.
Result<Method> make(const std::string& method, const CompareCommand& options, Stages& stages) {
  Result<Method> made = make_one(method, options, stages);
  if (made || made.error().where == "--method") return made;
  return Error{method + ": " + made.error().where, made.error().reason};
}

// All methods walk again, through a scene whose colours tell positions. `truth` draws the scene.
Result<> add_drawn_errors(const CompareCommand& options, const Scene& scene, FrameSource& truth,
                          const std::function<WalkFrame(int frame)>& walk,
                          const CompareOptions& compare_options, Report& report) {
  const Result<std::vector<double>> half_periods =
      choose_half_periods(scene, truth, walk, compare_options);
  if (!half_periods) return half_periods.error();
  const Scene coded = with_position_colors(scene, *half_periods);
  // A store knows pictures by their colours, too, but not by codes.
  CompareCommand of_coded = options;
  of_coded.method_options.impostors.store.clear();
  Stages stages(coded, options.frames.samples);
  std::vector<Method> methods;
  std::vector<ComparedSource> compared;
  for (const MethodResult& method : report.methods) {
    // Its polygons are others, and show their own positions where they lie.
    if (method.name == "lod" || (method.name == "cache" && options.method_options.levels)) continue;
    Result<Method> made = make(method.name, of_coded, stages);
    if (!made) return made.error();
    methods.push_back(std::move(*made));
    compared.push_back({method.name, methods.back().frames.get()});
  }
  return measure_drawn_errors(coded, *half_periods, compared, walk, compare_options, report);
}

// True frames with more samples, and who draws them.
struct TrueFrames {
  Method method;
  std::optional<ReferenceFrames> frames;
};

// Makes those that `options` ask for; leaves `frames` empty if they ask for none.
Result<> make_reference(const CompareCommand& options, const Scene& scene, Stages& stages,
                        TrueFrames& made) {
  if (options.reference == 0) return Done{};
  const int samples = options.frames.samples;
  if (!can_reference(options.reference, samples))
    return Error{"--reference", fmt::format("with --samples {0} it is {0}, {1}, {2} or {3}",
                                            samples, 4 * samples, 9 * samples, 16 * samples)};
  MethodOptions software = options.method_options;
  software.draw = "software";
  Result<Method> method = stages.all.make("direct-raster", software);
  if (!method) return method.error();
  made.method = std::move(*method);
  ReferenceOptions reference;
  reference.samples = options.reference;
  // By the clock no eye comes back to a place.
  if (!options.real_time) {
    reference.folder = options.reference_folder.empty()
                           ? std::filesystem::path(options.output) / "reference"
                           : std::filesystem::path(options.reference_folder);
    reference.scene = content_hash(scene);
  }
  made.frames.emplace(*made.method.frames, samples, std::move(reference));
  return Done{};
}

Result<> run_compare(CompareCommand options) {
  if (std::min(options.frames.width, options.frames.height) < kMinCompareSize)
    return Error{"--size",
                 fmt::format("frames to compare have at least {0}x{0} pixels", kMinCompareSize)};
  const std::filesystem::path folder = options.output;
  const std::filesystem::path report_file = folder / "report.json",
                              page_file = folder / "report.html";
  if (Result<> good = expect_outputs({report_file, page_file, options.json}); !good) return good;
  Result<OpenedScene> opened =
      open_scene(options.scene, options.limits, options.frames.scene_time(0),
                 options.file.empty() && !options.frames.time);
  if (!opened) return opened.error();
  if (!options.file.empty()) set_origin(opened->scene, options.baked.origin);
  const bool bends = !opened->deformations.meshes.empty();
  if (bends && options.drawn_error)
    return Error{
        "--drawn-error",
        fmt::format("{} bends by time, and colours that tell positions do not", options.scene)};
  const Result<FramePlan> plan = plan_frames(options.frames, *opened);
  if (!plan) return plan.error();
  set_eyes(*plan, options.method_options);
  const Result<ProgramScene> program =
      ProgramScene::create(options.scene, options.limits, opened->scene, options.method_options);
  if (!program) return program.error();
  options.method_options.impostors.background = options.real_time;
  options.method_options.by_clock = options.method_options.by_clock || options.real_time;
  Stages stages(opened->scene, options.frames.samples, &opened->deformations);
  std::vector<Method> methods;
  std::vector<ComparedSource> compared;
  std::vector<std::string> names =
      with_direct(options.methods, bends || options.method_options.draw == "software");
  if (options.one_sample) names.emplace_back(kOneSample);
  for (const std::string& name : names) {
    Result<Method> made = make(name, options, stages);
    if (!made) return made.error();
    methods.push_back(std::move(*made));
    compared.push_back({name, methods.back().frames.get()});
  }
  for (const std::string& foreign : options.foreign) {
    const std::size_t equals = foreign.find('=');
    if (equals == 0 || equals == std::string::npos)
      return Error{"--frames-of", foreign + " is not NAME=FOLDER"};
    compared.push_back({foreign.substr(0, equals), nullptr,
                        [of = foreign.substr(equals + 1), size = options.frames](int frame) {
                          return read_foreign(of, frame, size.width, size.height);
                        }});
  }

  TrueFrames true_frames;
  if (Result<> done = make_reference(options, opened->scene, stages, true_frames); !done)
    return done;

  CompareOptions compare_options;
  if (true_frames.frames) compare_options.reference = &*true_frames.frames;
  compare_options.width = options.frames.width;
  compare_options.height = options.frames.height;
  compare_options.samples = options.frames.samples;
  compare_options.frames = plan->frames;
  compare_options.pop = options.pop;
  Progress progress("frame");
  compare_options.progress = [&](int done, int total) { progress.show(done, total); };
  const auto walk = [&](int frame) {
    const double time = frame_time(plan->path, frame);
    return WalkFrame{camera_at(plan->path, time, options.frames.width, options.frames.height),
                     options.frames.scene_time(time)};
  };
  compare_options.limits = {
      options.method_options.error_px,
      gap_limit_px(options.method_options.error_px, options.method_options.gap_px)};
  RealTimeOptions real_time;
  real_time.seconds = plan->frames / kFramesPerSecond;
  real_time.limits = compare_options.limits;
  real_time.waits = true;
  // A slow method draws on until all frames to be compared are drawn: its eye must not stand.
  constexpr double kDrawsOn = 120;  // seconds
  const CameraPath path = there_and_back(plan->path, real_time.seconds + kDrawsOn);
  real_time.cuts = cuts_of(path);
  const double start = path.keys.front().time;
  const auto by_the_clock = [&](double seconds) {
    return WalkFrame{camera_at(path, start + seconds, options.frames.width, options.frames.height),
                     options.frames.scene_time(start + seconds)};
  };
  Result<Report> report =
      options.real_time ? compare_in_real_time(compared, by_the_clock, compare_options, real_time)
                        : compare(compared, walk, compare_options);
  if (!report) return report.error();
  if (bends)
    report->notes.push_back(
        "The scene bends by time, which OpenGL's polygons do not show: the true "
        "frames are direct-raster's, by software.");
  if (options.reference > 0)
    report->notes.push_back(
        fmt::format("Colours are compared with true frames of {} samples a pixel, those of {} too.",
                    options.reference, names.front()));
  if (options.drawn_error)
    if (Result<> done = add_drawn_errors(options, opened->scene, *compared[0].source, walk,
                                         compare_options, *report);
        !done)
      return done;
  progress.clear();
  report->commit = commit();
  report->scene_name = opened->scene.name.empty() ? options.scene : opened->scene.name;
  report->triangles = count_triangles(opened->scene);
  report->objects = opened->scene.objects.size();
  report->command = options.command_line;

  const std::string json = report_json(*report);
  if (Result<> done = write_text(report_file.string(), json); !done) return done;
  if (Result<> done = write_text(page_file.string(), report_html(*report)); !done) return done;
  if (!options.json.empty())
    if (Result<> done = write_text(options.json, json); !done) return done;
  if (options.json != "-") print_summary(*report);
  return Done{};
}

// Which is the scene, which the file, and which methods there are.
Result<> settle(CompareCommand& options, const std::string& given, const std::string& truth) {
  const bool is_file = holds_pictures(given);
  if (is_file && options.drawn_error)
    return Error{"--drawn-error",
                 "is for methods that draw a scene: a file has colours of its own"};
  if (is_file && truth.empty())
    return Error{
        given,
        "there are no true frames to compare it with: name the scene with --scene SCENE, the scene "
        "from which it was baked"};
  if (!is_file && !truth.empty())
    return Error{"--scene", "goes with the OpenEXR file of what was baked, not with a scene"};
  if (holds_pictures(truth)) return Error{truth, "is not a scene: it draws no true frames"};
  options.scene = is_file ? truth : given;
  options.file = is_file ? given : "";
  if (!is_file) {
    if (options.methods.empty()) options.methods = {"flat", "nailboard", "cache"};
    return Done{};
  }
  const Result<PictureFileContent> content = open_representation(given);
  if (!content) return content.error();
  options.baked = content->representation->world;
  // The scene as it was taken for the bake.
  if (!options.limits.up && options.baked.up != UpAxis::y) options.limits.up = options.baked.up;
  if (!options.limits.metres_per_unit && options.baked.metres_per_unit != 1)
    options.limits.metres_per_unit = options.baked.metres_per_unit;
  if (options.methods.empty()) options.methods = kind_method_names(*content->kind);
  for (const std::string& method : options.methods)
    if (method != "direct" && method != "direct-raster")
      if (Result<> known = expect_method_of(*content->kind, method, "--methods"); !known)
        return known;
  return Done{};
}

}  // namespace

Command compare_command(CLI::App& app) {
  auto options = std::make_shared<CompareCommand>();
  auto given = std::make_shared<std::string>(), truth = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "compare", "Measure methods along a camera path against direct drawing; write a report");
  command
      ->add_option("SCENE", *given,
                   std::string(kSceneHelp) + "; or the OpenEXR file of a baked representation")
      ->required();
  command
      ->add_option("--scene", *truth,
                   "The scene from which FILE was baked; required to compare a file")
      ->type_name("SCENE");
  command
      ->add_option(
          "--methods", options->methods,
          "Besides direct (without OpenGL direct-raster), which draws the true frames: " +
              fmt::format("{}", fmt::join(method_names(), ", ")) +
              " (default flat,nailboard,cache; for a file those of its kind). Where skins and "
              "morph targets move by time, the rasteriser draws the true frames")
      ->delimiter(',')
      ->check(known_method())
      ->type_name("A,B,...");
  command->add_option("-o,--output", options->output, "Folder for report.html and report.json")
      ->required()
      ->type_name("DIR");
  command->add_flag(
      "--pop", options->pop,
      "Also measure popping: how much more frames change than the true frames (slower)");
  command
      ->add_flag("--real-time", options->real_time,
                 "The eye moves by the clock: a slow method moves further per frame. Eight frames "
                 "of each method are compared (default: each method draws every frame of the path)")
      ->excludes("--pop");
  command
      ->add_flag("--drawn-error", options->drawn_error,
                 "Also measure how far from their true places surfaces are drawn: all methods walk "
                 "again, through a scene whose colours tell positions (takes twice as long)")
      ->excludes("--real-time");
  command->add_flag("--one-sample", options->one_sample,
                    "Also draw polygons with one sample a pixel, as direct-1-sample: what aliasing "
                    "alone does to the figures");
  command
      ->add_option("--frames-of", options->foreign,
                   "Also measure frames that another program drew of this path: "
                   "FOLDER/frame_00000.png ..., of this size; objects_00000.png ..., if they are "
                   "there, have the objects' identifiers (red + 256 green + 65536 blue). Again for "
                   "each program")
      ->excludes("--real-time", "--drawn-error")
      ->type_name("NAME=FOLDER");
  command
      ->add_option("--reference", options->reference,
                   "Compare colours with true frames of so many samples a pixel: as many as "
                   "--samples times 1, 4, 9 or 16, drawn by software (default: compare with "
                   "the frames of direct)")
      ->check(in_range(1, 64))
      ->type_name("N");
  command
      ->add_option("--reference-folder", options->reference_folder,
                   "Where these frames are kept, and found again for the same scene, eyes and size "
                   "(default DIR/reference; with --real-time none is kept)")
      ->type_name("DIR");
  add_frame_options(*command, options->frames);
  add_method_options(*command, options->method_options);
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  command->footer(
      "Example: rilievo compare builtin:bridge --methods flat,nailboard --frames 48 -o report");
  return {command, [options, given, truth](const std::string& command_line) -> Result<> {
            options->command_line = command_line;
            if (Result<> settled = settle(*options, *given, *truth); !settled) return settled;
            const Result<std::unique_ptr<gl::Context>> context =
                open_opengl(options->methods, options->frames.samples, options->method_options);
            if (!context) return context.error();
            return run_compare(*options);
          }};
}

}  // namespace rilievo::app

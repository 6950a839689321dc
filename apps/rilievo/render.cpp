// rilievo render SCENE -o DIR: draws the frames of a path into PNG or OpenEXR files; and the
// pictures with depth that they were drawn from, which it also draws, as it does what was baked.

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/methods.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/picture_file.h"
#include "apps/rilievo/program_scene.h"
#include "apps/rilievo/progress.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/io/png.h"
#include "rilievo/measure/stats.h"

namespace rilievo::app {
namespace {

constexpr char kPicturesMethod[] = "nailboard";

struct RenderCommand {
  std::string scene, output, pictures, json, method, format = "png";
  std::vector<std::string> beside;  // other files, in the same frames
  FileLimits limits;
  double loop_seconds = 0;
  FrameOptions frames;
  MethodOptions methods;
};

// Where the eye is in each frame.
struct Walk {
  FramePlan plan;
  std::optional<Camera> only;        // instead of the plan's cameras
  std::optional<double> still = {};  // the scene's time, instead of the path's
  WorldSpace world = {};             // where the eyes' space lies

  [[nodiscard]] int frames() const { return only ? 1 : plan.frames; }
  [[nodiscard]] double time(int frame) const {
    return still ? *still : only ? 0.0 : frame_time(plan.path, frame);
  }
  [[nodiscard]] Camera camera(int frame, int width, int height) const {
    return only ? *only : camera_at(plan.path, frame_time(plan.path, frame), width, height);
  }
};

std::string numbered(const std::string& folder, const char* stem, int frame,
                     const std::string& extension) {
  return (std::filesystem::path(folder) / fmt::format("{}_{:05}{}", stem, frame, extension))
      .string();
}

Result<> save_pictures_of(const FrameSource& source, const RenderCommand& options,
                          const WorldSpace& world, const Camera& camera, int frame) {
  const FramePictures saved{source.read_pictures(), camera, options.methods.delta_bits, world};
  // A frame of nothing but light objects has none.
  if (saved.pictures.empty()) return Done{};
  return save_frame_pictures(numbered(options.pictures, "pictures", frame, ".exr"), saved);
}

// Before the time is spent.
Result<> expect_places(const RenderCommand& options) {
  std::filesystem::path frames, pictures;
  if (!options.output.empty()) frames = numbered(options.output, "frame", 0, "." + options.format);
  if (!options.pictures.empty()) pictures = numbered(options.pictures, "pictures", 0, ".exr");
  return expect_outputs({frames, pictures, options.json});
}

Result<> save_frame(const RenderCommand& options, const BackendTarget& target, const Camera& camera,
                    const WorldSpace& world, int frame) {
  if (options.format == "png")
    return save_png(numbered(options.output, "frame", frame, ".png"), target.color());
  return save_frame_pictures(
      numbered(options.output, "frame", frame, ".exr"),
      {{read_picture(target, camera)}, {}, options.methods.delta_bits, world});
}

Result<> draw_frames(const RenderCommand& options, const Walk& walk, int width, int height,
                     const Stage& stage, FrameSource& source) {
  const Result<std::unique_ptr<BackendTarget>> target = stage.make_target(source, width, height);
  if (!target) return target.error();
  for (const std::string& folder : {options.output, options.pictures})
    if (Result<> made = make_folder(folder); !made) return made;
  std::vector<double> frame_ms;
  std::vector<std::string> drawn_by;  // of methods that choose between others
  int captures = 0;
  Progress progress("frame");
  for (int frame = 0; frame < walk.frames(); ++frame) {
    progress.show(frame, walk.frames());
    const Camera camera = walk.camera(frame, width, height);
    const Stopwatch watch;
    if (Result<> drawn = (*target)->draw(source, camera, walk.time(frame)); !drawn) return drawn;
    frame_ms.push_back(watch.ms());
    captures += source.stats().captures;
    if (!source.stats().decision.method.empty())
      drawn_by.push_back(source.stats().decision.sentence());
    if (Result<> saved = save_frame(options, **target, camera, walk.world, frame); !saved)
      return saved;
    if (options.pictures.empty()) continue;
    if (Result<> saved = save_pictures_of(source, options, walk.world, camera, frame); !saved)
      return saved;
  }
  if (options.json.empty()) return Done{};
  const Summary ms = summarize(frame_ms);
  nlohmann::json json{{"schema", "rilievo-render-1"},
                      {"scene", options.scene},
                      {"method", options.method},
                      {"size", {width, height}},
                      {"samples", options.frames.samples},
                      {"draw", source.software_target() ? "software" : "opengl"},
                      {"frames", walk.frames()},
                      {"frame_ms", {{"p50", ms.p50}, {"p99", ms.p99}, {"max", ms.max}}},
                      {"captures", captures},
                      {"picture_bytes", source.stats().picture_bytes}};
  if (!drawn_by.empty()) json["drawn_by"] = drawn_by;
  return write_json(options.json, json);
}

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * double(sysconf(_SC_PAGESIZE)) / double(1 << 20);
}

// Draws the path over and over, writes no frames, and watches the memory: a cache must not grow.
Result<> loop(const RenderCommand& options, const Walk& walk, const Stage& stage,
              FrameSource& source) {
  const Result<std::unique_ptr<BackendTarget>> target =
      stage.make_target(source, options.frames.width, options.frames.height);
  if (!target) return target.error();
  const Stopwatch watch;
  double after_warm_up_mb = 0, most_mb = 0;
  // The first minute fills pools and caches; of a short loop, the first tenth.
  const double warm_up = std::min(60.0, 0.1 * options.loop_seconds);
  std::int64_t frames = 0, captures = 0;
  Progress progress("second");
  for (double now = 0; now < options.loop_seconds; now = 1e-3 * watch.ms(), ++frames) {
    const int frame = int(frames % walk.frames());
    const Camera camera = walk.camera(frame, options.frames.width, options.frames.height);
    if (Result<> drawn = (*target)->draw(source, camera, walk.time(frame)); !drawn) return drawn;
    captures += source.stats().captures;
    if (frames % 16 == 0) progress.show(int(now), int(options.loop_seconds));
    const double mb = resident_mb();
    if (now >= warm_up && after_warm_up_mb == 0) after_warm_up_mb = mb;
    most_mb = std::max(most_mb, mb);
  }
  progress.clear();
  const nlohmann::json json{
      {"schema", "rilievo-loop-1"}, {"scene", options.scene},
      {"method", options.method},   {"seconds", 1e-3 * watch.ms()},
      {"frames", frames},           {"captures", captures},
      {"warm_up_seconds", warm_up}, {"memory_mb_after_warm_up", after_warm_up_mb},
      {"memory_mb_most", most_mb},  {"memory_mb_at_the_end", resident_mb()}};
  if (options.json.empty()) {
    print(
        "{} frames in {:.0f} s; memory {:.0f} MB after {:.0f} s, {:.0f} MB at the end, at "
        "most {:.0f} MB\n",
        frames, 1e-3 * watch.ms(), after_warm_up_mb, warm_up, resident_mb(), most_mb);
    return Done{};
  }
  return write_json(options.json, json);
}

// Frames have the size asked for, or that of the only camera.
Result<> draw_or_loop(const RenderCommand& options, const Walk& walk, const Stage& stage,
                      FrameSource& source) {
  if (options.loop_seconds > 0) return loop(options, walk, stage, source);
  return draw_frames(options, walk, walk.only ? walk.only->width : options.frames.width,
                     walk.only ? walk.only->height : options.frames.height, stage, source);
}

Result<> render_scene(const RenderCommand& options) {
  if (!options.pictures.empty() && options.method == "direct")
    return Error{"--save-pictures", "direct drawing uses no pictures"};
  if (!options.pictures.empty() && kind_method(options.method).kind)
    return Error{"--save-pictures", fmt::format("{} is saved by rilievo bake",
                                                kind_method(options.method).kind->name)};
  const Result<OpenedScene> opened =
      open_scene(options.scene, options.limits, options.frames.scene_time(0), !options.frames.time);
  if (!opened) return opened.error();
  const Result<FramePlan> plan = plan_frames(options.frames, *opened);
  if (!plan) return plan.error();
  MethodOptions methods = options.methods;
  set_eyes(*plan, methods);
  const Result<ProgramScene> program =
      ProgramScene::create(options.scene, options.limits, opened->scene, methods);
  if (!program) return program.error();
  const Result<std::unique_ptr<gl::Context>> context =
      open_opengl({&options.method, 1}, options.frames.samples, methods);
  if (!context) return context.error();
  Stage stage(opened->scene, options.frames.samples, &opened->deformations);
  Result<Method> method = stage.make(options.method, methods);
  if (!method) return method.error();
  return draw_or_loop(options, {*plan, {}, options.frames.time, opened->scene.world}, stage,
                      *method->frames);
}

// The eye of the frame that the pictures were saved from; else that of the first picture.
Result<Walk> walk_of(const RenderCommand& options, const FramePictures& stored) {
  Walk walk;
  if (!options.frames.path_file.empty()) {
    const Result<FramePlan> plan = plan_frames(options.frames, Box{}, stored.world.origin);
    if (!plan) return plan.error();
    walk.plan = *plan;
    return walk;
  }
  const FrameOptions& frames = options.frames;
  for (const auto& [name, given] :
       {std::pair("--orbit", frames.orbit > 0), std::pair("--walk", frames.walk > 0),
        std::pair("--frames", frames.frames > 0), std::pair("--size", frames.sized)})
    if (given)
      return Error{name,
                   "pictures of a file are drawn once, for the eye and the size that they "
                   "were saved for; --path draws others"};
  walk.only = stored.camera ? *stored.camera : stored.pictures.front().camera;
  if (!is_frame_size(walk.only->width, walk.only->height))
    return Error{options.scene, fmt::format("a frame of {}x{} pixels is not between 1x1 and "
                                            "8192x8192; --path and --size draw others",
                                            walk.only->width, walk.only->height)};
  return walk;
}

Result<> render_pictures(const RenderCommand& options, const FramePictures& stored) {
  const Result<Walk> walk = walk_of(options, stored);
  if (!walk) return walk.error();
  const Scene nothing;
  Stage stage(nothing, options.frames.samples);
  Result<Method> method =
      stage.make(options.method, options.methods, stored.pictures, stored.delta_bits);
  if (!method && method.error().where.starts_with("--")) return method.error();
  if (!method) return Error{options.scene, method.error().where + ": " + method.error().reason};
  return draw_or_loop(options, *walk, stage, *method->frames);
}

Result<> render_representation(const RenderCommand& options, PictureFileContent content) {
  const Result<FramePlan> plan = plan_frames(options.frames, *content.representation);
  if (!plan) return plan.error();
  std::vector<StoredBeside> beside;
  for (const std::string& file : options.beside) {
    Result<PictureFileContent> other = open_representation(file);
    if (!other) return other.error();
    beside.push_back({other->kind, std::move(other->representation)});
  }
  const Scene nothing;
  Stage stage(nothing, options.frames.samples);
  Result<Method> method = stage.make(options.method, options.methods,
                                     std::move(content.representation), std::move(beside));
  if (!method)
    return method.error().where.starts_with("--") ? method.error()
                                                  : Error{options.scene, method.error().reason};
  return draw_or_loop(options, {*plan, {}}, stage, *method->frames);
}

Result<> render_file(RenderCommand options) {
  Result<PictureFileContent> content = open_pictures(options.scene);
  if (!content) return content.error();
  if (options.method.empty())
    options.method = content->kind ? std::string(content->kind->name) : kPicturesMethod;
  if (content->kind) {
    if (Result<> known = expect_method_of(*content->kind, options.method, "--method"); !known)
      return known;
  } else if (options.method != kPicturesMethod) {
    return Error{"--method",
                 fmt::format("the pictures of {} are drawn as {}", options.scene, kPicturesMethod)};
  }
  if (!content->kind && !options.beside.empty())
    return Error{"--with", "is for baked files, and " + options.scene + " holds plain pictures"};
  if (!options.pictures.empty())
    return Error{"--save-pictures", "these pictures are in a file already"};
  const Result<std::unique_ptr<gl::Context>> context =
      open_opengl({&options.method, 1}, options.frames.samples, options.methods);
  if (!context) return context.error();
  return content->kind ? render_representation(options, std::move(*content))
                       : render_pictures(options, content->frame);
}

}  // namespace

Command render_command(CLI::App& app) {
  auto options = std::make_shared<RenderCommand>();
  CLI::App* command = app.add_subcommand("render", "Draw the frames of a camera path");
  command
      ->add_option("SCENE", options->scene,
                   std::string(kSceneHelp) +
                       "; or an OpenEXR file of pictures with depth or of a baked representation")
      ->required();
  command
      ->add_option("--with", options->beside,
                   "Of a baked file: another one in the same frames, such as an object among nodes "
                   "(bake --only, --without); may be repeated")
      ->type_name("FILE.exr")
      ->allow_extra_args(false);
  auto* output =
      command->add_option("-o,--output", options->output, "Folder for frame_00000.png ...")
          ->type_name("DIR");
  auto* loop_seconds =
      command
          ->add_option(
              "--loop-seconds", options->loop_seconds,
              "Instead of writing frames, repeat the path for this time and report the memory used")
          ->check(in_range(0.1, 1e6))
          ->type_name("S");
  output->excludes(loop_seconds);
  command
      ->add_option(
          "--method", options->method,
          "The drawing method (default auto; with --save-pictures nailboard; for a file, its kind)")
      ->check(known_method());
  command
      ->add_option("--save-pictures", options->pictures,
                   "Folder for the pictures from which each frame is drawn, pictures_00000.exr ...")
      ->type_name("DIR")
      ->excludes(loop_seconds);
  command
      ->add_option(
          "--format", options->format,
          "What frames are written as: png, sRGB, or exr, linear light with depths (Z), for "
          "programs that composite (default png)")
      ->check(CLI::IsMember({"png", "exr"}))
      ->excludes(loop_seconds);
  add_frame_options(*command, options->frames);
  add_method_options(*command, options->methods);
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  command->footer("Example: rilievo render model.glb --orbit 60 --size 640x360 -o frames");
  return {command, [options](const std::string&) -> Result<> {
            if (options->output.empty() && options->loop_seconds == 0)
              return Error{"-o", "the folder for the frames is missing"};
            if (Result<> good = expect_places(*options); !good) return good;
            if (holds_pictures(options->scene)) {
              if (options->frames.time) return Error{"--time", "pictures of a file do not move"};
              return render_file(*options);
            }
            if (!options->beside.empty())
              return Error{"--with", "is for baked files, and " + options->scene + " is a scene"};
            if (options->method.empty())
              options->method =
                  options->pictures.empty() ? default_method(options->methods) : kPicturesMethod;
            return render_scene(*options);
          }};
}

}  // namespace rilievo::app

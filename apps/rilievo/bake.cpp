// rilievo bake SCENE -o FILE.exr: pictures with depth of a scene from all around, in one file that
// draws without the scene.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "apps/rilievo/bake_command.h"
#include "apps/rilievo/bake_pieces.h"
#include "apps/rilievo/bake_source.h"
#include "apps/rilievo/capture.h"
#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/frame_options.h"
#include "apps/rilievo/kinds.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/progress.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/capture/deep_image_source.h"
#include "rilievo/capture/pose_origin.h"
#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/capture/store/picture_folder.h"
#include "rilievo/capture/store/picture_store.h"
#include "rilievo/capture/watched_source.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/frame/gl/opengl_target.h"
#include "rilievo/gl/context.h"
#include "rilievo/io/deep_exr.h"
#include "rilievo/measure/stats.h"
#include "rilievo/method/direct.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

using Clock = std::chrono::steady_clock;

// The store of a bake loses none of its pictures.
constexpr std::uint64_t kMostKept = std::uint64_t(1) << 40;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What one frame of the scene costs without pictures, all of it in view; milliseconds, median.
Result<double> direct_ms(SceneRenderer& renderer, int width, int height) {
  Result<OpenGLTarget> target = OpenGLTarget::create(width, height, 4);
  if (!target) return target.error();
  constexpr int kFrames = 5;
  const CameraPath path = orbit_path(world_bounds(renderer.scene()), kFrames);
  OpenGLFrames direct(renderer, std::make_unique<DirectChooser>());
  std::vector<double> ms;
  // One more to warm up.
  for (int frame = 0; frame <= kFrames; ++frame) {
    const Camera camera = camera_at(path, frame_time(path, frame), width, height);
    const Result<double> took = time_frame(direct, *target, {camera, 0});
    if (!took) return took.error();
    if (frame > 0) ms.push_back(*took);
  }
  return summarize(ms).p50;
}

struct Times {
  double capture_s = 0, build_s = 0, save_s = 0;
  int pictures = 0;
  std::size_t file_bytes = 0;

  [[nodiscard]] double seconds() const { return capture_s + build_s + save_s; }
  [[nodiscard]] double ms_per_picture() const {
    return pictures > 0 ? 1e3 * seconds() / pictures : 0;
  }
};

// Of a program, or of an option: more than the scene's name says.
bool names_itself(const std::string& where) {
  return where.starts_with("--") || where.starts_with("exec:");
}

// Bakes and saves. `found`: how many pictures came from what was kept; may be empty.
Result<Baked> bake(const BakeCommand& options, const Kind& kind, const OptionValues& values,
                   CaptureSource& source, const Box& eyes,
                   const std::vector<std::uint32_t>& objects, Times& times,
                   const std::function<int()>& found = {}) {
  app::Progress progress(options.counted, options.json_progress);
  const Clock::time_point start = Clock::now();
  int total = 0;
  // Slow sources set their own samples.
  const int samples = is_slow_source(options.source.source) ? 0 : options.source.samples;
  WatchedSource watched(source, samples, [&](int done) -> Result<> {
    if (total > 0) progress.show(done, total, found ? found() : 0);
    return Done{};
  });
  Result<Baked> baked = kind.bake({watched, objects, eyes}, values, [&](int done, int all) {
    if (total == 0) progress.show(done, all, found ? found() : 0);
    total = all;
    times.capture_s = seconds_since(start);
    times.pictures = all;
  });
  if (!baked)
    return names_itself(baked.error().where) ? baked.error()
                                             : Error{options.scene, baked.error().reason};
  times.build_s = seconds_since(start) - times.capture_s;
  const Clock::time_point saving = Clock::now();
  if (Result<> saved = kind.save(*baked->representation, options.output); !saved)
    return saved.error();
  times.save_s = seconds_since(saving);
  // A device has no size.
  if (std::filesystem::is_regular_file(options.output))
    times.file_bytes = std::filesystem::file_size(options.output);
  return baked;
}

// What the bake and the kind say of what was made.
nlohmann::json report_of(const BakeCommand& options, const Kind& kind, const OptionValues& values,
                         const Baked& baked, const Times& times) {
  nlohmann::json json{{"schema", "rilievo-bake-1"}, {"scene", options.scene}, {"as", kind.name}};
  for (const Fact& fact : kind.describe(*baked.representation))
    json[fact.key] = nlohmann::json::parse(fact.json);
  for (const Fact& fact : baked.facts) json[fact.key] = nlohmann::json::parse(fact.json);
  if (values.has("size")) json["size"] = values.integer("size");
  json["file_bytes"] = times.file_bytes;
  json["seconds"] = {{"capture", times.capture_s},
                     {"slice", times.build_s},  // former name of "build"
                     {"build", times.build_s},
                     {"save", times.save_s},
                     {"total", times.seconds()}};
  return json;
}

// And how it compares with drawing the scene directly.
Result<> add_direct(const OptionValues& values, const Times& times, SceneRenderer& renderer,
                    nlohmann::json& json) {
  const int size = values.has("size") ? values.integer("size") : 256;
  const Result<double> small = direct_ms(renderer, size, size);
  if (!small) return small.error();
  const Result<double> large = direct_ms(renderer, 1280, 720);
  if (!large) return large.error();
  const std::string square = fmt::format("{0}x{0}", size);
  json["triangles"] = count_triangles(renderer.scene());
  json["ms_per_view"] = times.ms_per_picture();
  json["direct_ms"] = {{square, *small}, {"1280x720", *large}};
  json["direct_frames_per_view"] = {{square, times.ms_per_picture() / *small},
                                    {"1280x720", times.ms_per_picture() / *large}};
  return Done{};
}

void print_made(const BakeCommand& options, const Kind& kind, const Baked& baked,
                const Times& times) {
  print("{}: {}, {:.1f} MB, {:.1f} s\n", options.output, kind.name, 1e-6 * double(times.file_bytes),
        times.seconds());
  std::vector<Fact> facts = kind.describe(*baked.representation);
  facts.insert(facts.end(), baked.facts.begin(), baked.facts.end());
  for (const Fact& fact : facts)
    if (!fact.label.empty()) print("  {:<10} {}\n", fact.label, fact.text);
}

// Of what has no polygons to compare with.
Result<> bake_without_scene(const BakeCommand& options, const Kind& kind,
                            const OptionValues& values, CaptureSource& source) {
  Times times;
  const Result<Baked> baked = bake(options, kind, values, source, {}, {}, times);
  if (!baked) return baked.error();
  if (!options.json.empty())
    return write_json(options.json, report_of(options, kind, values, *baked, times));
  print_made(options, kind, *baked, times);
  return Done{};
}

// A deep image of any renderer's.
Result<DeepImageSource> open_deep(const BakeCommand& options) {
  DeepLoadOptions load;
  if (options.fov_degrees > 0) load.fov = glm::radians(options.fov_degrees);
  if (options.ray_depth) load.depth_kind = DepthKind::ray;
  Result<LayeredDepthImage> layers = load_layers(options.scene, load);
  if (!layers) {
    std::string reason = layers.error().reason;
    if (reason.find("has no camera") != std::string::npos)
      reason += ": --fov DEGREES gives one, at the origin, looking along -z";
    return Error{options.scene, reason};
  }
  glm::dmat4* const pose = &layers->camera.world_from_eye;
  const WorldSpace world = take_origin_off({&pose, 1});
  std::vector<LayeredDepthImage> pictures;
  pictures.push_back(*std::move(layers));
  return DeepImageSource(options.scene, std::move(pictures), world);
}

// How many pictures a slow source rendered, and how many were there from before.
void add_pictures(const BakeSource& source, const std::string& where, Baked& baked) {
  if (source.rendered() + source.found() == 0) return;
  baked.facts.push_back(
      {"pictures",
       nlohmann::json{{"rendered", source.rendered()}, {"kept", source.found()}, {"in", where}}
           .dump(),
       "pictures",
       fmt::format("{} rendered, {} from {}", source.rendered(), source.found(), where)});
}

// Coarse walks in the place of the output, each finer than the one before, for people to look at
// meanwhile: faces (or sizes) and samples grow from an eighth to a half of what was asked for.
Result<> bake_previews(const BakeCommand& options, const Kind& kind, PictureKeeper* keeper) {
  const Clock::time_point start = Clock::now();
  const OptionValues usual(kind.bake_options);
  const std::string_view sized = usual.has("face") ? "face" : "size";
  if (!usual.has(sized)) return Error{"--preview", fmt::format("{} has no sizes", kind.name)};
  for (const int part : {8, 4, 2}) {
    BakeCommand coarse = options;
    const Result<OptionValues> values = bake_values(kind, options.kinds);
    if (!values) return values.error();
    coarse.kinds.bake[std::string(sized)] =
        std::to_string(std::max(16, values->integer(sized) / part));
    coarse.source.samples =
        std::max(1, (options.source.samples > 0 ? options.source.samples : 4) / (part * part));
    coarse.source.keeper = keeper;
    coarse.counted = "preview";
    const Result<OptionValues> fewer = bake_values(kind, coarse.kinds);
    if (!fewer) return fewer.error();
    Result<BakeSource> source = BakeSource::open(options.scene, options.limits, coarse.source);
    if (!source) return source.error();
    Times times;
    const Result<Baked> baked =
        bake(coarse, kind, *fewer, source->source(), source->eyes(), source->objects(), times,
             [&source] { return int(source->found()); });
    if (!baked) return baked.error();
    show_written(options.output,
                 fmt::format("a preview with {} of {} texels a side, {} samples",
                             coarse.kinds.bake[std::string(sized)], values->integer(sized),
                             coarse.source.samples),
                 seconds_since(start), options.json_progress);
  }
  return Done{};
}

Result<> finish(const BakeCommand& options, const Kind& kind, const OptionValues& values,
                BakeSource& source, const std::string& kept_in) {
  Times times;
  Result<Baked> baked = bake(options, kind, values, source.source(), source.eyes(),
                             source.objects(), times, [&source] { return int(source.found()); });
  if (!baked) return baked.error();
  add_pictures(source, kept_in, *baked);
  if (options.json.empty()) {
    print_made(options, kind, *baked, times);
    return Done{};
  }
  nlohmann::json json = report_of(options, kind, values, *baked, times);
  if (source.renderer())
    if (Result<> added = add_direct(values, times, *source.renderer(), json); !added) return added;
  return write_json(options.json, json);
}

// What the plan's file says and the command line confirms.
Result<BakePlan> open_plan(const BakeCommand& options) {
  Result<BakePlan> plan = load_plan(options.plan);
  if (!plan) return plan;
  const std::string& source = plan->command.source.source;
  const std::string_view program = program_named(source);
  if (program.empty()) return plan;
  if (options.source.source.empty())
    return Error{"--source", "must name the program again, as no file starts one: " + source};
  std::error_code failed;
  const std::string_view named = program_named(options.source.source);
  if (named != program && std::filesystem::absolute(named, failed).lexically_normal() != program)
    return Error{"--source", options.source.source + " is not what was planned: " + source};
  return plan;
}

// All from the pieces, which must be there.
Result<> join_pieces(const BakeCommand& options, const BakePlan& plan) {
  BakeCommand whole = plan.command;
  whole.json = options.json;
  whole.json_progress = options.json_progress;
  if (!options.output.empty()) whole.output = options.output;
  const Kind& kind = *find_kind(kinds(), whole.as);
  const Result<OptionValues> values = bake_values(kind, whole.kinds);
  if (!values) return values.error();
  if (Result<> good = expect_outputs({whole.output, whole.json}); !good) return good;
  PictureFolder folder(pictures_of(options.plan));
  whole.source.keeper = &folder;
  Result<BakeSource> source = BakeSource::open(whole.scene, whole.limits, whole.source);
  if (!source) return source.error();
  if (!source->light() || source->kept().content != plan.content)
    return Error{whole.scene, "has changed since " + options.plan + " was made: plan it again"};
  if (const std::vector<int> missing = missing_pieces(plan, options.plan, source->kept());
      !missing.empty())
    return Error{options.plan,
                 fmt::format("{} of {} {} missing", list_of_pieces(missing),
                             plan.pieces.pictures.size(), missing.size() == 1 ? "is" : "are")};
  if (Result<> made = make_folder(std::filesystem::path(whole.output).parent_path()); !made)
    return made;
  return finish(whole, kind, *values, *source, folder.path().string());
}

Result<> run_step(const BakeCommand& options, BakeStep step) {
  const Result<BakePlan> plan = open_plan(options);
  if (!plan) return plan.error();
  if (step == BakeStep::join) return join_pieces(options, *plan);
  const Result<bool> made = make_piece(*plan, options.plan, *options.piece);
  if (!made) return made.error();
  print("piece {} of {}: {}\n", *options.piece, plan->pieces.pictures.size(),
        *made ? "rendered" : "was there");
  return Done{};
}

// "12 pieces of 36 pictures, of about 8.1 s each (7.6 to 8.8)".
std::string sentence_of(const BakePlan& plan) {
  const PieceGroups& pieces = plan.pieces;
  std::string text = fmt::format("{} pieces", pieces.pictures.size());
  if (pieces.pictures.size() != plan.pictures.size())
    text += fmt::format(" of {} pictures", plan.pictures.size());
  const double mean = std::accumulate(pieces.seconds.begin(), pieces.seconds.end(), 0.0) /
                      double(std::max<std::size_t>(1, pieces.seconds.size()));
  if (mean > 0)
    text += fmt::format(", of about {:.2g} s each ({:.2g} to {:.2g})", mean, pieces.least * mean,
                        pieces.most * mean);
  return text;
}

// Writes the plan; by Slurm, runs it, too.
Result<> plan_bake(BakeCommand options, BakeStep step, const Kind& kind,
                   const OptionValues& values) {
  if (step == BakeStep::slurm)
    if (Result<> there = expect_slurm(); !there) return there;
  if (options.plan.empty()) options.plan = options.output + ".pieces.json";
  if (Result<> good = expect_outputs({options.plan}); !good) return good;
  Result<BakeSource> source = BakeSource::open(options.scene, options.limits, options.source);
  if (!source) return source.error();
  const Result<BakePlan> plan =
      make_plan(options, *source,
                [&](CaptureSource& recorder, const std::function<void(int, int)>& progress) {
                  const Result<Baked> baked =
                      kind.bake({recorder, source->objects(), source->eyes()}, values, progress);
                  return baked ? Result<>(Done{}) : Result<>(baked.error());
                });
  if (!plan) return plan.error();
  if (Result<> made = make_folder(std::filesystem::path(options.plan).parent_path()); !made)
    return made;
  if (Result<> saved = save_plan(*plan, options.plan); !saved) return saved;
  if (step == BakeStep::plan) {
    print("{}: {}\n", options.plan, sentence_of(*plan));
    return Done{};
  }
  options.plan = std::filesystem::absolute(options.plan).lexically_normal().string();
  if (Result<> run = run_by_slurm(*plan, options.plan, *options.at_a_time, source->kept(),
                                  options.json_progress);
      !run)
    return run;
  return join_pieces(options, *plan);
}

Result<> run_bake(const BakeCommand& options) {
  const Result<BakeStep> step = step_of(options);
  if (!step) return step.error();
  if (*step == BakeStep::piece || *step == BakeStep::join) return run_step(options, *step);
  if (!is_picture_file(options.output))
    return Error{options.output, "the output is an OpenEXR file: the name must end in .exr"};
  // Before the time is spent.
  const Kind& kind = *find_kind(kinds(), options.as);
  if (Result<> good = expect_options_of(kind, options.kinds); !good) return good;
  const Result<OptionValues> values = bake_values(kind, options.kinds);
  if (!values) return values.error();
  const bool slow = is_slow_source(options.source.source);
  const std::string store =
      !slow || !options.store.empty() ? options.store : options.output + ".pictures";
  if (Result<> good = expect_outputs({options.output, options.json, store}); !good) return good;
  const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
  if (holds_pictures(options.scene)) {
    if (!options.source.only.empty() || !options.source.without.empty())
      return Error{options.source.only.empty() ? "--without" : "--only",
                   "is for scenes, and " + options.scene + " is a deep image"};
    if (Result<> good = expect_no_units(options.scene, options.limits); !good) return good;
    if (!options.source.source.empty())
      return Error{"--source", "is for scenes, and " + options.scene + " is a deep image"};
    Result<DeepImageSource> source = open_deep(options);
    if (!source) return source.error();
    if (Result<> made = make_folder(folder); !made) return made;
    return bake_without_scene(options, kind, *values, *source);
  }
  const bool program = !program_named(options.source.source).empty();
  if (options.fov_degrees > 0 || (options.ray_depth && !program))
    return Error{options.fov_degrees > 0 ? "--fov" : "--ray-depth",
                 "is for deep images, which " + options.scene + " is not"};
  if (*step != BakeStep::whole) return plan_bake(options, *step, kind, *values);
  if (!slow) {
    Result<BakeSource> source = BakeSource::open(options.scene, options.limits, options.source);
    if (!source) return source.error();
    if (Result<> made = make_folder(folder); !made) return made;
    if (is_capture(options.scene))
      return bake_without_scene(options, kind, *values, source->source());
    return finish(options, kind, *values, *source, "");
  }
  for (const std::filesystem::path& place : {folder, std::filesystem::path(store).parent_path()})
    if (Result<> made = make_folder(place); !made) return made;
  Result<PictureStore> keeper = PictureStore::open(store, {.max_bytes = kMostKept});
  if (!keeper) return keeper.error();
  if (options.preview)
    if (Result<> shown = bake_previews(options, kind, &*keeper); !shown) return shown;
  SourceOptions of_source = options.source;
  of_source.keeper = &*keeper;
  Result<BakeSource> source = BakeSource::open(options.scene, options.limits, of_source);
  if (!source) return source.error();
  return finish(options, kind, *values, *source, store);
}

}  // namespace

Command bake_command(CLI::App& app) {
  auto options = std::make_shared<BakeCommand>();
  std::vector<std::string_view> deep;
  for (const Kind* kind : kinds())
    if (kind->takes_deep_images) deep.push_back(kind->name);
  CLI::App* command = app.add_subcommand(
      "bake", "Bake a representation of a scene or of photographs into one file");
  command->add_option(
      "SCENE", options->scene,
      fmt::format("{}, or a capture: a folder of photographs with depth and their poses, or a "
                  "manifest of Google's Seurat; or, for {}, a deep OpenEXR image",
                  kSceneHelp, fmt::join(deep, ", ")));
  command
      ->add_option("--as", options->as,
                   fmt::format("The kind of representation (default {})", options->as))
      ->check(CLI::IsMember(kind_names()));
  add_kind_options(*command, KindOptionsOf::bake, options->kinds);
  command
      ->add_option("--fov", options->fov_degrees,
                   "Of a deep image without a camera: its horizontal field of view")
      ->check(in_range(0.1, 179.0))
      ->type_name("DEGREES");
  command->add_flag("--ray-depth", options->ray_depth,
                    "Of a deep image or a program: Z is the distance along the line of sight, not "
                    "along the axis");
  command->add_option("-o,--output", options->output, "The file to write")->type_name("FILE.exr");
  add_source_options(*command, *options);
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  std::string examples =
      "Example: rilievo bake model.glb --views 32 --size 256 -o model.exr\n"
      "         rilievo bake capture/ --box -1,-1,0,1,1,2 -o corner.exr\n"
      "         rilievo bake room.glb --as environment-nodes --source raytrace --samples 64 -o "
      "room.exr\n";
  for (const std::string_view kind : deep)
    examples +=
        fmt::format("         rilievo bake deep.exr --as {} --fov 54 -o deep-{}.exr\n", kind, kind);
  command->footer(examples + "         rilievo render model.exr --orbit 60 -o frames");
  return {command, [options](const std::string&) {
            if (options->ray_depth) options->source.depth_kind = DepthKind::ray;
            if (options->axis_depth) options->source.depth_kind = DepthKind::eye_z;
            return run_bake(*options);
          }};
}

}  // namespace rilievo::app

// rilievo bake SCENE -o FILE.exr: pictures with depth of a scene from all around, in one file that
// draws without the scene.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

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
#include "rilievo/core/camera_path.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/io/deep_exr.h"
#include "rilievo/measure/stats.h"
#include "rilievo/method/direct.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {
namespace {

struct BakeCommand {
  std::string scene, output, json, as{default_kind().name};
  double fov_degrees = 0;  // of a deep image that does not say; 0: not given
  bool ray_depth = false;  // of a deep image: Z is along the line of sight
  KindOptions kinds;
  FileLimits limits;
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// What one frame of the scene costs without pictures, all of it in view; milliseconds, median.
Result<double> direct_ms(SceneRenderer& renderer, int width, int height) {
  Result<FrameTarget> target = FrameTarget::create(width, height, 4);
  if (!target) return target.error();
  constexpr int kFrames = 5;
  const CameraPath path = orbit_path(world_bounds(renderer.scene()), kFrames);
  OpenGLFrames direct(renderer, std::make_unique<DirectChooser>());
  std::vector<double> ms;
  // One more to warm up.
  for (int frame = 0; frame <= kFrames; ++frame) {
    const Camera camera = camera_at(path, frame_time(path, frame), width, height);
    const Clock::time_point start = Clock::now();
    target->begin();
    if (Result<> drawn = direct.draw(camera, 0); !drawn) return drawn.error();
    target->resolve();
    gl::finish();
    if (frame > 0) ms.push_back(1e3 * seconds_since(start));
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

// Bakes and saves.
Result<Baked> bake(const BakeCommand& options, const Kind& kind, const OptionValues& values,
                   CaptureSource& source, const Box& eyes, Times& times) {
  app::Progress progress("view");
  const Clock::time_point start = Clock::now();
  Result<Baked> baked = kind.bake({source, {}, eyes}, values, [&](int done, int total) {
    progress.show(done, total);
    times.capture_s = seconds_since(start);
    times.pictures = total;
  });
  if (!baked)
    return baked.error().where.starts_with("--") ? baked.error()
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
  const Result<Baked> baked = bake(options, kind, values, source, {}, times);
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

Result<> run_bake(const BakeCommand& options) {
  if (!is_picture_file(options.output))
    return Error{options.output, "the output is an OpenEXR file: the name must end in .exr"};
  // Before the time is spent.
  const Kind& kind = *find_kind(kinds(), options.as);
  if (Result<> good = expect_options_of(kind, options.kinds); !good) return good;
  const Result<OptionValues> values = bake_values(kind, options.kinds);
  if (!values) return values.error();
  if (Result<> good = expect_outputs({options.output, options.json}); !good) return good;
  const std::filesystem::path folder = std::filesystem::path(options.output).parent_path();
  if (holds_pictures(options.scene)) {
    if (Result<> good = expect_no_units(options.scene, options.limits); !good) return good;
    Result<DeepImageSource> source = open_deep(options);
    if (!source) return source.error();
    if (Result<> made = make_folder(folder); !made) return made;
    return bake_without_scene(options, kind, *values, *source);
  }
  if (options.fov_degrees > 0 || options.ray_depth)
    return Error{options.fov_degrees > 0 ? "--fov" : "--ray-depth",
                 "is for deep images, which " + options.scene + " is not"};
  Result<BakeSource> source = BakeSource::open(options.scene, options.limits);
  if (!source) return source.error();
  if (Result<> made = make_folder(folder); !made) return made;
  if (is_capture(options.scene))
    return bake_without_scene(options, kind, *values, source->source());
  Times times;
  const Result<Baked> baked = bake(options, kind, *values, source->source(), source->eyes(), times);
  if (!baked) return baked.error();
  if (options.json.empty()) {
    print_made(options, kind, *baked, times);
    return Done{};
  }
  nlohmann::json json = report_of(options, kind, *values, *baked, times);
  if (source->renderer())
    if (Result<> added = add_direct(*values, times, *source->renderer(), json); !added)
      return added;
  return write_json(options.json, json);
}

}  // namespace

Command bake_command(CLI::App& app) {
  auto options = std::make_shared<BakeCommand>();
  std::vector<std::string_view> deep;
  for (const Kind* kind : kinds())
    if (kind->takes_deep_images) deep.push_back(kind->name);
  CLI::App* command = app.add_subcommand(
      "bake", "Bake a representation of a scene or of photographs into one file");
  command
      ->add_option(
          "SCENE", options->scene,
          fmt::format("{}, or a capture: a folder of photographs with depth and their poses, or a "
                      "manifest of Google's Seurat; or, for {}, a deep OpenEXR image",
                      kSceneHelp, fmt::join(deep, ", ")))
      ->required();
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
  command->add_flag(
      "--ray-depth", options->ray_depth,
      "Of a deep image: Z is the distance along the line of sight, not along the axis");
  command->add_option("-o,--output", options->output, "The file to write")
      ->required()
      ->type_name("FILE.exr");
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  std::string examples =
      "Example: rilievo bake model.glb --views 32 --size 256 -o model.exr\n"
      "         rilievo bake capture/ --box -1,-1,0,1,1,2 -o corner.exr\n";
  for (const std::string_view kind : deep)
    examples +=
        fmt::format("         rilievo bake deep.exr --as {} --fov 54 -o deep-{}.exr\n", kind, kind);
  command->footer(examples + "         rilievo render model.exr --orbit 60 -o frames");
  return {command, [options](const std::string&) { return run_bake(*options); }};
}

}  // namespace rilievo::app

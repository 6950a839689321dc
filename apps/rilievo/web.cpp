// rilievo web FILE.exr|SCENE -o DIR: a folder that any web host serves and any browser walks
// through.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
#include "apps/rilievo/kinds.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/picture_file.h"
#include "apps/rilievo/progress.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/representation/kinds.h"
#include "rilievo/web_walk/picture_files.h"
#include "rilievo/web_walk/walks.h"

namespace rilievo::app {
namespace {

struct WebCommand {
  std::string input, output, json, as;
  std::vector<std::string> beside;  // other baked files
  KindOptions kinds;
  FileLimits limits;
  WalkOptions walk;
};

// What is written, and where a walk through it begins.
struct WebInput {
  const Kind* kind = nullptr;
  std::unique_ptr<Representation> representation;
  FramePictures pictures;  // of no kind
  std::optional<CameraPath> path;
  std::vector<Fact> facts;  // of the bake
};

Result<WebInput> bake_for_web(const WebCommand& options) {
  WebInput input;
  input.kind = find_kind(kinds(), options.as.empty() ? walk_kinds().front() : options.as);
  if (Result<> good = expect_options_of(*input.kind, options.kinds); !good) return good.error();
  const Result<OptionValues> values = bake_values(*input.kind, options.kinds);
  if (!values) return values.error();
  Result<BakeSource> source = BakeSource::open(options.input, options.limits);
  if (!source) return source.error();
  app::Progress progress("view");
  Result<Baked> baked = input.kind->bake({source->source(), {}, source->eyes()}, *values,
                                         [&](int done, int total) { progress.show(done, total); });
  if (!baked)
    return baked.error().where.starts_with("--") ? baked.error()
                                                 : Error{options.input, baked.error().reason};
  input.representation = std::move(baked->representation);
  input.facts = std::move(baked->facts);
  if (source->walk()) input.path = *source->walk();
  return input;
}

Result<WebInput> read_for_web(const WebCommand& options) {
  if (!options.as.empty() || !options.kinds.bake.empty())
    return Error{options.as.empty() ? "--" + options.kinds.bake.begin()->first : "--as",
                 "says how a scene is baked, and " + options.input + " is baked already"};
  Result<PictureFileContent> content = open_pictures(options.input);
  if (!content) return content.error();
  WebInput input;
  input.kind = content->kind;
  input.representation = std::move(content->representation);
  input.pictures = std::move(content->frame);
  return input;
}

// A frame's pictures are seen from its own eye; others from that of the first.
void stand_at_frame(const FramePictures& frame, WalkManifest& manifest) {
  const Camera& camera = frame.camera ? *frame.camera : frame.pictures.front().camera;
  manifest.eye = camera.position();
  manifest.target = manifest.eye + camera.forward();
  manifest.up = glm::dvec3(camera.world_from_eye[1]);
  manifest.vertical_fov = std::atan(camera.window.top) - std::atan(camera.window.bottom);
  if (!frame.camera) return;
  manifest.z_near = camera.z_near;
  manifest.z_far = camera.z_far;
}

WalkManifest manifest_of(const WebCommand& options, const WebInput& input) {
  WalkManifest manifest;
  manifest.name = std::filesystem::path(options.input).stem().string();
  if (!input.kind) {
    stand_at_frame(input.pictures, manifest);
    return manifest;
  }
  if (options.input.starts_with("builtin:"))
    manifest.name = options.input.substr(8, options.input.find('?') - 8);
  const Vantage vantage = input.representation->vantage();
  manifest.up = vantage.up;
  manifest.origin = input.representation->world.origin;
  std::optional<CameraPath> path = input.path;
  if (!path) path = input.representation->walk();
  if (!path) path = walk_path(input.representation->bounds(), 2, vantage);
  const PathKey& key = path->keys.front();
  manifest.eye = key.eye;
  manifest.target = key.eye + key.world_from_eye * glm::dvec3(0, 0, -1);
  manifest.vertical_fov = key.vertical_fov;
  manifest.z_near = path->z_near;
  manifest.z_far = path->z_far;
  return manifest;
}

// A walk begins where a node stands, the one nearest to where its path begins: between nodes, what
// none of them saw is missing.
void begin_at_node(WalkManifest& manifest) {
  if (manifest.nodes.empty()) return;
  const auto away = [&](const WalkNode& node) {
    return glm::distance(glm::dvec3(node.world_from_node[3]), manifest.eye);
  };
  const WalkNode& nearest = *std::ranges::min_element(manifest.nodes, {}, away);
  const glm::dvec3 gaze = manifest.target - manifest.eye;
  manifest.eye = glm::dvec3(nearest.world_from_node[3]);
  manifest.target = manifest.eye + gaze;
}

// A page draws nodes, and one object among them.
Result<> expect_beside(const WalkManifest& walk, const PictureFileContent& other,
                       const std::string& file) {
  if (walk.nodes.empty())
    return Error{"--with", "is for environment nodes, among which objects stand"};
  if (other.kind->stands_for != StandsFor::objects)
    return Error{"--with", file + " holds no object but " + std::string(other.kind->name)};
  if (!walk.pictures.pictures.empty() || !walk.reliefs.reliefs.empty())
    return Error{"--with", "a page draws one object among nodes, and " + file + " is another"};
  if (other.representation->world.origin != walk.origin)
    return Error{"--with", file + " lies in another space than the nodes: bake both of one scene"};
  return Done{};
}

Result<> run_web(const WebCommand& options) {
  // Before the time is spent.
  if (Result<> good =
          expect_outputs({std::filesystem::path(options.output) / "walk.json", options.json});
      !good)
    return good;
  const Stopwatch watch;
  Result<WalkWriter> writer = WalkWriter::create(options.output);
  if (!writer) return writer.error();
  Result<WebInput> input =
      holds_pictures(options.input) ? read_for_web(options) : bake_for_web(options);
  if (!input) return input.error();
  WalkManifest manifest = manifest_of(options, *input);
  {
    app::Progress progress("node");
    WalkOptions walk = options.walk;
    walk.progress = [&](int done, int total) { progress.show(done, total); };
    const Result<> added =
        input->kind ? add_to_walk(*input->kind, *input->representation, *writer, manifest, walk)
                    : add_nailboards(input->pictures.pictures, input->pictures.delta_bits, *writer,
                                     manifest, walk);
    if (!added)
      return Error{options.input,
                   added.error().where.empty() ? added.error().reason : added.error().message()};
  }
  for (const std::string& file : options.beside) {
    const Result<PictureFileContent> other = open_representation(file);
    if (!other) return other.error();
    if (Result<> good = expect_beside(manifest, *other, file); !good) return good;
    if (Result<> added =
            add_to_walk(*other->kind, *other->representation, *writer, manifest, options.walk);
        !added)
      return Error{file, added.error().reason};
  }
  begin_at_node(manifest);
  if (Result<> done = writer->finish(manifest); !done) return done;
  const double seconds = 1e-3 * watch.ms();
  const std::size_t first = writer->first_view_bytes(manifest);
  const std::string_view kind_name = input->kind ? input->kind->name : "nailboards";
  if (!options.json.empty()) {
    nlohmann::json json{{"schema", "rilievo-web-1"}, {"input", options.input},
                        {"kind", kind_name},         {"files", writer->files()},
                        {"bytes", writer->bytes()},  {"first_view_bytes", first},
                        {"seconds", seconds}};
    for (const Fact& fact : input->facts) json[fact.key] = nlohmann::json::parse(fact.json);
    return write_json(options.json, json);
  }
  print("{}: {}, {:.1f} MB in {} files, the first view after {:.2f} MB, {:.1f} s\n", options.output,
        kind_name, 1e-6 * double(writer->bytes()), writer->files(), 1e-6 * double(first), seconds);
  for (const Fact& fact : input->facts)
    if (!fact.label.empty()) print("  {:<10} {}\n", fact.label, fact.text);
  print("  serve it   python3 -m http.server -d {}\n", options.output);
  return Done{};
}

}  // namespace

Command web_command(CLI::App& app) {
  auto options = std::make_shared<WebCommand>();
  const std::vector<std::string_view> names = walk_kinds();
  CLI::App* command = app.add_subcommand(
      "web", "Write a folder that a web host serves and a browser walks through");
  command
      ->add_option("INPUT", options->input,
                   fmt::format("What was baked: an OpenEXR file; or what is baked first: {}, or a "
                               "capture of photographs",
                               kSceneHelp))
      ->required();
  command
      ->add_option("--with", options->beside,
                   "Beside nodes: the baked file of an object that stands among them (bake --only, "
                   "--without)")
      ->type_name("FILE.exr")
      ->allow_extra_args(false);
  command
      ->add_option("--as", options->as,
                   fmt::format("The kind that a scene is baked as (default {})", names.front()))
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  add_kind_options(*command, KindOptionsOf::bake, options->kinds);
  command
      ->add_option("--psnr", options->walk.least_psnr_db,
                   fmt::format("The least PSNR of stored colours, decibels (default {})",
                               options->walk.least_psnr_db))
      ->check(in_range(20.0, 60.0))
      ->type_name("DB");
  command
      ->add_option("--rounding-px", options->walk.rounding_px,
                   fmt::format("The most that rounding of stored depths moves a texel, pixels "
                               "(default {})",
                               options->walk.rounding_px))
      ->check(in_range(0.001, 10.0))
      ->type_name("PIXELS");
  command
      ->add_option("--coarse", options->walk.coarse_face,
                   fmt::format("Texels a side of the faces that are loaded first (default {})",
                               options->walk.coarse_face))
      ->check(in_range(8, 4096))
      ->type_name("N");
  command->add_flag("--objects", options->walk.objects,
                    "With identifiers of objects, to measure what a browser draws");
  command->add_option("-o,--output", options->output, "The folder to write")
      ->required()
      ->type_name("DIR");
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  command->footer(
      "Example: rilievo web builtin:stonehenge -o walk && python3 -m http.server -d walk\n"
      "         rilievo web room.exr -o walk");
  return {command, [options](const std::string&) { return run_web(*options); }};
}

}  // namespace rilievo::app

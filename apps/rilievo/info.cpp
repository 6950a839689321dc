// rilievo info FILE: what is in it? rilievo info --machine: how fast is this machine? rilievo info
// --kinds: which kinds of representation are there, and what are their options?

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/rilievo/capture.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/kinds.h"
#include "apps/rilievo/machine.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/picture_file.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/core/place_text.h"
#include "rilievo/io/png.h"
#include "rilievo/relief_impostor/valid_eyes.h"

namespace rilievo::app {
namespace {

struct InfoCommand {
  std::string file, json, valid_eyes;
  bool machine = false, kinds = false;
  FileLimits limits;
};

const char* name_of(UpAxis axis) {
  constexpr const char* kNames[] = {"x", "y", "z"};
  return kNames[int(axis)];
}

// How the file's coordinates were taken and why, and where the scene is kept.
void print_world(const WorldSpace& world, const char* why) {
  print("  taken as   {} up, {}{}\n", name_of(world.up),
        world.metres_per_unit == 1 ? std::string("metres")
                                   : fmt::format("units of {:g} m", world.metres_per_unit),
        why);
  if (world.origin != glm::dvec3(0)) print("  origin     {} m\n", place_text(world.origin, 1));
}

// Why a scene is in metres with y up, if no option says otherwise.
const char* why_taken(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (file.starts_with("builtin:")) return "";
  return extension == ".glb" || extension == ".gltf"
             ? " (glTF's; --up and --units take it otherwise)"
             : " (assumed, the format does not say; --up and --units take it otherwise)";
}

const char* name_of(Projection projection) {
  switch (projection) {
    case Projection::perspective:
      return "perspective";
    case Projection::back_perspective:
      return "back-perspective";
    case Projection::parallel:
      return "parallel";
  }
  return "";
}

// Points and lines of all objects, and the diameters of points: metres of the world, or pixels.
struct Strokes {
  std::uint64_t points = 0, lines = 0;
  double smallest = 0, largest = 0, pixels = 0;
};

Strokes count_strokes(const Scene& scene) {
  Strokes out;
  std::vector<glm::mat4> poses;
  pose(scene, 0, poses);
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (const Part& part : scene.models[std::size_t(scene.objects[i].model)].parts) {
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      if (mesh.primitive == Primitive::lines) out.lines += mesh.primitives();
      if (mesh.primitive != Primitive::points) continue;
      out.points += mesh.primitives();
      const double metres = double(mesh.width) * smallest_stretch(poses[i] * part.model_from_mesh);
      if (metres <= 0) {
        out.pixels = std::max(out.pixels, double(mesh.width_px));
        continue;
      }
      out.smallest = out.smallest > 0 ? std::min(out.smallest, metres) : metres;
      out.largest = std::max(out.largest, metres);
    }
  return out;
}

Result<> describe_scene(const InfoCommand& options) {
  const Result<OpenedScene> opened = open_scene(options.file, options.limits);
  if (!opened) return opened.error();
  const Scene& scene = opened->scene;
  const Box bounds = world_bounds(scene);
  const double size = double(bounds.radius());
  const glm::dvec3 low = scene.world.origin + glm::dvec3(bounds.min),
                   high = scene.world.origin + glm::dvec3(bounds.max);
  std::size_t moving = 0, texels = 0, stored = 0;
  for (const Object& object : scene.objects) moving += object.moving ? 1 : 0;
  for (const Rgba8Image& image : scene.images) texels += image.texels().size();
  for (const Mesh& mesh : scene.meshes) stored += mesh.triangles();
  const Strokes strokes = count_strokes(scene);
  if (!options.json.empty()) {
    nlohmann::json json{
        {"schema", "rilievo-info-1"},
        {"name", scene.name},
        {"triangles", count_triangles(scene) - strokes.points - strokes.lines},
        {"points", strokes.points},
        {"lines", strokes.lines},
        {"point_size",
         {{"min_m", strokes.smallest}, {"max_m", strokes.largest}, {"pixels", strokes.pixels}}},
        {"stored_triangles", stored},
        {"objects", scene.objects.size()},
        {"moving_objects", moving},
        {"models", scene.models.size()},
        {"meshes", scene.meshes.size()},
        {"materials", scene.materials.size()},
        {"textures", scene.textures.size()},
        {"texels", texels},
        {"lights", scene.lights.size()},
        {"cameras", scene.cameras.size()},
        {"duration_s", scene.duration}};
    if (!bounds.empty()) {
      json["bounds_min"] = list_of(low);
      json["bounds_max"] = list_of(high);
    }
    json["origin"] = list_of(scene.world.origin);
    json["up"] = name_of(scene.world.up);
    json["metres_per_unit"] = scene.world.metres_per_unit;
    return write_json(options.json, json);
  }
  print("{}\n", options.file);
  print("  triangles  {} ({} stored)\n", count_triangles(scene) - strokes.points - strokes.lines,
        stored);
  if (strokes.points > 0)
    print("  points     {}, {}\n", strokes.points,
          strokes.largest > 0
              ? fmt::format("{:.3g} to {:.3g} m in diameter", strokes.smallest, strokes.largest)
              : fmt::format("{:.3g} pixels in diameter", strokes.pixels));
  if (strokes.lines > 0) print("  lines      {}, a pixel wide\n", strokes.lines);
  print("  objects    {} ({} moving)\n", scene.objects.size(), moving);
  print("  models     {} of {} meshes\n", scene.models.size(), scene.meshes.size());
  print("  materials  {}, textures {} ({:.1f} Mtexels)\n", scene.materials.size(),
        scene.textures.size(), 1e-6 * double(texels));
  print("  lights     {}, cameras {}\n", scene.lights.size(), scene.cameras.size());
  if (scene.duration > 0) print("  animation  {:.3g} s\n", scene.duration);
  if (!bounds.empty())
    print("  bounds     {} to {} m\n", place_text(low, size), place_text(high, size));
  print_world(scene.world,
              options.limits.up && options.limits.metres_per_unit ? "" : why_taken(options.file));
  return Done{};
}

Result<> describe_representation(const InfoCommand& options, const Kind& kind,
                                 const Representation& representation) {
  std::error_code none;
  const std::size_t file_bytes = std::filesystem::file_size(options.file, none);
  const std::vector<Fact> facts = kind.describe(representation);
  if (!options.json.empty()) {
    nlohmann::json json{
        {"schema", "rilievo-info-1"}, {"representation", kind.name}, {"file_bytes", file_bytes}};
    for (const Fact& fact : facts) json[fact.key] = nlohmann::json::parse(fact.json);
    json["origin"] = list_of(representation.world.origin);
    json["up"] = name_of(representation.world.up);
    json["metres_per_unit"] = representation.world.metres_per_unit;
    return write_json(options.json, json);
  }
  print("{}\n  kind       {}, {:.1f} MB in the file\n", options.file, kind.name,
        1e-6 * double(file_bytes));
  for (const Fact& fact : facts)
    if (!fact.label.empty()) print("  {:<10} {}\n", fact.label, fact.text);
  print_world(representation.world, "");
  return Done{};
}

Result<> describe_pictures(const InfoCommand& options) {
  const Result<PictureFileContent> content = open_pictures(options.file);
  if (!content) return content.error();
  if (content->kind)
    return describe_representation(options, *content->kind, *content->representation);
  const std::vector<DepthImage>& pictures = content->frame.pictures;
  nlohmann::json list = nlohmann::json::array();
  if (options.json.empty()) print("{}\n  {} pictures with depth\n", options.file, pictures.size());
  for (const DepthImage& picture : pictures) {
    const Camera& camera = picture.camera;
    std::size_t covered = 0;
    for (const float depth : picture.depth.texels()) covered += depth != kNoDepth ? 1 : 0;
    const double share =
        double(covered) / double(std::max<std::size_t>(1, picture.depth.texels().size()));
    if (options.json.empty())
      print("  {:<24} {}x{} {} from {}, depth {:.4g} to {:.4g} m, {:.1f} % covered\n",
            picture.name.empty() ? "(no name)" : picture.name, camera.width, camera.height,
            name_of(camera.projection),
            place_text(content->frame.world.origin + camera.position(), camera.z_near),
            camera.z_near, camera.z_far, 100 * share);
    list.push_back({{"name", picture.name},
                    {"size", {camera.width, camera.height}},
                    {"projection", name_of(camera.projection)},
                    {"position", list_of(content->frame.world.origin + camera.position())},
                    {"z_near", camera.z_near},
                    {"z_far", camera.z_far},
                    {"covered", share}});
  }
  if (options.json.empty()) return Done{};
  return write_json(options.json, {{"schema", "rilievo-info-1"}, {"pictures", list}});
}

// From above: the eyes for which a relief impostor of the first picture needs no other (S5.3).
// Nothing nearer than its nearest surface is an eye.
Result<> save_valid_eyes(const InfoCommand& options) {
  const Result<PictureFileContent> content = open_pictures(options.file);
  if (!content) return content.error();
  if (content->kind || content->frame.pictures.empty())
    return Error{"--valid-eyes", "is for plain pictures with depth (render --save-pictures)"};
  const DepthImage& picture = content->frame.pictures.front();
  if (picture.camera.projection != Projection::perspective)
    return Error{"--valid-eyes", "is for pictures in perspective"};
  const ImpostorPicture impostor = impostor_picture(picture);
  if (impostor.empty()) return Error{options.file, "its first picture shows nothing"};
  ValidEyesOptions map;
  map.size = 129;
  map.extent = picture.camera.z_near;
  const ValidEyes eyes = valid_eyes(impostor, map);
  if (Result<> made = make_folder(std::filesystem::path(options.valid_eyes).parent_path()); !made)
    return made;
  if (Result<> saved = save_png(options.valid_eyes, picture_of(eyes)); !saved) return saved;
  const auto& all = eyes.valid.texels();
  print("{}: {:.0f} % of the eyes within {:.3g} m to each side are valid (green)\n",
        options.valid_eyes,
        100.0 * double(std::count(all.begin(), all.end(), 1)) / double(all.size()), map.extent);
  return Done{};
}

}  // namespace

Command info_command(CLI::App& app) {
  auto options = std::make_shared<InfoCommand>();
  CLI::App* command =
      app.add_subcommand("info", "Show what a scene or a file of pictures contains");
  CLI::Option* file = command->add_option(
      "FILE", options->file,
      std::string(kSceneHelp) + ", pictures in OpenEXR, or a folder of photographs with depth");
  command
      ->add_flag("--machine", options->machine,
                 "Measure what drawing and capturing take on this machine instead, in a second or "
                 "two; the file of --json is what --machine of other commands reads")
      ->excludes(file);
  command
      ->add_flag("--kinds", options->kinds,
                 "List the kinds of representation and their options instead, which --set of other "
                 "commands takes")
      ->excludes(file);
  command
      ->add_option("--valid-eyes", options->valid_eyes,
                   "Of pictures: a map, from above, of the eyes for which a relief impostor of the "
                   "first one stays valid, as PNG")
      ->type_name("MAP.png")
      ->needs(file);
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  command->footer(
      "Example: rilievo info model.glb\n         rilievo info --machine --json machine.json");
  return {command, [options](const std::string&) -> Result<> {
            if (Result<> good = expect_outputs({options->json, options->valid_eyes}); !good)
              return good;
            if (!options->valid_eyes.empty()) return save_valid_eyes(*options);
            if (options->machine) return describe_machine(options->json);
            if (options->kinds) return list_kinds(options->json);
            if (options->file.empty())
              return Error{"info", "FILE, --machine or --kinds is required"};
            if (is_capture(options->file))
              return describe_capture(options->file, options->json, options->limits);
            return holds_pictures(options->file) ? describe_pictures(*options)
                                                 : describe_scene(*options);
          }};
}

}  // namespace rilievo::app

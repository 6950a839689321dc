// rilievo info FILE: what is in it?

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/rilievo/capture.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/rgbd.h"
#include "rilievo/layered_impostor/file.h"
#include "rilievo/layered_impostor/gl/layered_pictures.h"

namespace rilievo::app {
namespace {

struct Options {
  std::string file, json;
  FileLimits limits;
};

std::string text_of(const glm::vec3& v) {
  return fmt::format("{:.4g} {:.4g} {:.4g}", v.x, v.y, v.z);
}

nlohmann::json list_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

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

Result<> describe_scene(const Options& options) {
  const Result<OpenedScene> opened = open_scene(options.file, options.limits);
  if (!opened) return opened.error();
  const Scene& scene = opened->scene;
  const Box bounds = world_bounds(scene);
  std::size_t moving = 0, texels = 0, stored = 0;
  for (const Object& object : scene.objects) moving += object.moving ? 1 : 0;
  for (const Rgba8Image& image : scene.images) texels += image.texels().size();
  for (const Mesh& mesh : scene.meshes) stored += mesh.triangles();
  if (!options.json.empty()) {
    nlohmann::json json{{"schema", "rilievo-info-1"},
                        {"name", scene.name},
                        {"triangles", count_triangles(scene)},
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
      json["bounds_min"] = list_of(bounds.min);
      json["bounds_max"] = list_of(bounds.max);
    }
    return write_json(options.json, json);
  }
  print("{}\n", options.file);
  print("  triangles  {} ({} stored)\n", count_triangles(scene), stored);
  print("  objects    {} ({} moving)\n", scene.objects.size(), moving);
  print("  models     {} of {} meshes\n", scene.models.size(), scene.meshes.size());
  print("  materials  {}, textures {} ({:.1f} Mtexels)\n", scene.materials.size(),
        scene.textures.size(), 1e-6 * double(texels));
  print("  lights     {}, cameras {}\n", scene.lights.size(), scene.cameras.size());
  if (scene.duration > 0) print("  animation  {:.3g} s\n", scene.duration);
  if (!bounds.empty()) print("  bounds     {} to {} m\n", text_of(bounds.min), text_of(bounds.max));
  return Done{};
}

std::size_t texture_bytes(const LayeredImpostor& impostor, LayeredMethod method) {
  int width = 0, height = 0;
  for (const DepthImage& picture : impostor.pictures) {
    width = std::max(width, picture.camera.width);
    height = std::max(height, picture.camera.height);
  }
  return layered_texture_bytes(int(impostor.pictures.size()), width, height, method);
}

Result<> describe_layered(const Options& options, const LayeredImpostor& impostor) {
  const LayeredFigures figures = analyze_layered_impostor(impostor);
  const DepthImage& first = impostor.pictures.front();
  const std::size_t views = impostor.pictures.size();
  std::size_t texels = 0;
  for (const DepthImage& picture : impostor.pictures) texels += picture.depth.texels().size();
  const double coverage = double(figures.covered_texels) / double(texels);
  const std::size_t surfaces = texture_bytes(impostor, LayeredMethod::surfaces);
  const std::size_t slices = texture_bytes(impostor, LayeredMethod::slices);
  std::error_code none;
  const std::size_t file_bytes = std::filesystem::file_size(options.file, none);
  if (!options.json.empty()) {
    const nlohmann::json json{{"schema", "rilievo-info-1"},
                              {"representation", "layered-impostor"},
                              {"views", views},
                              {"size", {first.camera.width, first.camera.height}},
                              {"projection", name_of(first.camera.projection)},
                              {"layers", impostor.slicing.layers},
                              {"overlap", impostor.slicing.overlap},
                              {"file_bytes", file_bytes},
                              {"paper_bytes", figures.paper_bytes},
                              {"texture_bytes", {{"surfaces", surfaces}, {"slices", slices}}},
                              {"coverage", coverage},
                              {"slices", figures.slices},
                              {"empty_slices", figures.empty_slices},
                              {"fill_share", figures.fill_share},
                              {"fill_saved", figures.fill_saved},
                              {"holes_looked_for", !impostor.fills.empty()},
                              {"hole_slices", figures.hole_slices},
                              {"hole_fill_share", figures.hole_fill_share},
                              {"bounds_min", list_of(impostor.bounds.min)},
                              {"bounds_max", list_of(impostor.bounds.max)}};
    return write_json(options.json, json);
  }
  print("{}\n  a layered impostor\n", options.file);
  print("  views      {} {} pictures of {}x{}\n", views, name_of(first.camera.projection),
        first.camera.width, first.camera.height);
  print(
      "  memory     {:.1f} MB in the file; {:.1f} MB as 4 bytes a texel; textures {:.1f} MB "
      "for surfaces, {:.1f} MB for slices\n",
      1e-6 * double(file_bytes), 1e-6 * double(figures.paper_bytes), 1e-6 * double(surfaces),
      1e-6 * double(slices));
  print("  coverage   {:.1f} % of the texels show something\n", 100 * coverage);
  print("  slices     {} of {} layers a view, overlap {}; {} empty ones dropped\n", figures.slices,
        impostor.slicing.layers, impostor.slicing.overlap, figures.empty_slices);
  print("  fill       {:.1f} % of the texels of full slices are drawn\n", 100 * figures.fill_share);
  if (impostor.fills.empty())
    print("  holes      not looked for\n");
  else
    print("  holes      of a view filled by {:.1f} slices of a neighbour, {:.1f} % of its fill\n",
          figures.hole_slices, 100 * figures.hole_fill_share);
  print("  bounds     {} to {} m\n", text_of(impostor.bounds.min), text_of(impostor.bounds.max));
  return Done{};
}

Result<> describe_pictures(const Options& options) {
  Result<PictureFile> opened = load_picture_file(options.file);
  if (!opened) return opened.error();
  if (says_layered_impostor(opened->attributes)) {
    const Result<LayeredImpostor> impostor =
        layered_impostor_from(std::move(*opened), options.file);
    if (!impostor) return impostor.error();
    return describe_layered(options, *impostor);
  }
  nlohmann::json list = nlohmann::json::array();
  if (options.json.empty())
    print("{}\n  {} pictures with depth\n", options.file, opened->pictures.size());
  for (const DepthImage& picture : opened->pictures) {
    const Camera& camera = picture.camera;
    std::size_t covered = 0;
    for (const float depth : picture.depth.texels()) covered += depth != kNoDepth ? 1 : 0;
    const double share =
        double(covered) / double(std::max<std::size_t>(1, picture.depth.texels().size()));
    if (options.json.empty())
      print("  {:<24} {}x{} {} from {}, depth {:.4g} to {:.4g} m, {:.1f} % covered\n",
            picture.name.empty() ? "(no name)" : picture.name, camera.width, camera.height,
            name_of(camera.projection), text_of(camera.position()), camera.z_near, camera.z_far,
            100 * share);
    list.push_back({{"name", picture.name},
                    {"size", {camera.width, camera.height}},
                    {"projection", name_of(camera.projection)},
                    {"position", list_of(camera.position())},
                    {"z_near", camera.z_near},
                    {"z_far", camera.z_far},
                    {"covered", share}});
  }
  if (options.json.empty()) return Done{};
  return write_json(options.json, {{"schema", "rilievo-info-1"}, {"pictures", list}});
}

}  // namespace

Command info_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("info", "Say what a scene or a file of pictures holds");
  command
      ->add_option(
          "FILE", options->file,
          std::string(kSceneHelp) + ", pictures in OpenEXR, or a folder of photographs with depth")
      ->required();
  add_json_option(*command, options->json);
  add_file_limits(*command, options->limits);
  command->footer("Example: rilievo info model.glb");
  return {command, [options](const std::string&) -> Result<> {
            if (Result<> good = expect_outputs({options->json}); !good) return good;
            if (is_rgbd_capture(options->file))
              return describe_capture(options->file, options->json, options->limits);
            return holds_pictures(options->file) ? describe_pictures(*options)
                                                 : describe_scene(*options);
          }};
}

}  // namespace rilievo::app

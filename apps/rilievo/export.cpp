// rilievo export FILE.exr -o FILE.glb: the textured mesh of what was baked, for other programs.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/rilievo/checks.h"
#include "apps/rilievo/command.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/picture_file.h"
#include "rilievo/scene/files/save_glb.h"

namespace rilievo::app {
namespace {

struct ExportCommand {
  std::string file, output;
  int part = 0;
  bool gaps = false;
};

Result<> run_export(const ExportCommand& options) {
  const std::filesystem::path file = options.output;
  if (file.extension() != ".glb")
    return Error{options.output, "meshes are written as binary glTF: the name must end in .glb"};
  if (Result<> good = expect_outputs({options.output}); !good) return good;
  const Result<PictureFileContent> content = open_representation(options.file);
  if (!content) return content.error();
  const Kind& kind = *content->kind;
  if (!kind.to_scene)
    return Error{options.file, fmt::format("holds {}, which has no mesh", kind.name)};
  Result<Scene> scene = kind.to_scene(*content->representation, {options.part, !options.gaps});
  if (!scene)
    return scene.error().where.starts_with("--") ? scene.error()
                                                 : Error{options.file, scene.error().reason};
  scene->world = content->representation->world;
  if (Result<> made = make_folder(file.parent_path()); !made) return made;
  return save_glb(*scene, file);
}

}  // namespace

Command export_command(CLI::App& app) {
  auto options = std::make_shared<ExportCommand>();
  CLI::App* command =
      app.add_subcommand("export", "Write the mesh of what was baked as a GLB file");
  command->add_option("FILE", options->file, "The OpenEXR file of environment nodes")->required();
  command->add_option("-o,--output", options->output, "The file to write")
      ->required()
      ->type_name("FILE.glb");
  command->add_option("--node", options->part, "Which of the nodes, from 0 (default 0)")
      ->check(in_range(0, 1'000'000))
      ->type_name("N");
  command->add_flag("--gaps", options->gaps, "Without skins: gaps between surfaces stay open");
  command->footer("Example: rilievo export room.exr -o room.glb");
  return {command, [options](const std::string&) { return run_export(*options); }};
}

}  // namespace rilievo::app

// rilievo scene NAME -o FILE.glb: a built-in scene as a file that other programs open.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/rilievo/command.h"
#include "apps/rilievo/output.h"
#include "apps/rilievo/scene_file.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/scene/files/save_glb.h"

namespace rilievo::app {
namespace {

struct SceneCommand {
  std::string scene, output, path;
  FileLimits limits;
};

Result<> run_scene(const SceneCommand& options) {
  const std::filesystem::path file = options.output;
  if (file.extension() != ".glb")
    return Error{options.output, "scenes are written as binary glTF: the name must end in .glb"};
  if (Result<> good = expect_outputs({options.output, options.path}); !good) return good;
  // "bridge" is short for "builtin:bridge"; a file is converted.
  std::error_code unreadable;  // open_scene() says why
  const bool is_file = std::filesystem::exists(options.scene, unreadable) || unreadable;
  const bool is_spec = options.scene.starts_with("builtin:");
  const Result<OpenedScene> opened =
      open_scene(is_file || is_spec ? options.scene : "builtin:" + options.scene, options.limits);
  if (!opened) return opened.error();
  for (const std::string& name : {options.output, options.path})
    if (Result<> made = make_folder(std::filesystem::path(name).parent_path()); !made) return made;
  if (Result<> saved = save_glb(opened->scene, file); !saved) return saved;
  if (options.path.empty()) return Done{};
  const CameraPath path =
      opened->walk ? *opened->walk : orbit_path(world_bounds(opened->scene), 120);
  return save_path(relative_to(-opened->scene.world.origin, path), options.path);
}

}  // namespace

Command scene_command(CLI::App& app) {
  auto options = std::make_shared<SceneCommand>();
  CLI::App* command = app.add_subcommand("scene", "Write a built-in scene as a GLB file");
  command
      ->add_option("NAME", options->scene,
                   "bridge, forest, teapots, stonehenge, teapot, fern, fish or cube, with "
                   "?triangles=N&seed=S; or a scene file")
      ->required();
  command->add_option("-o,--output", options->output, "The file to write")
      ->required()
      ->type_name("FILE.glb");
  command->add_option("--save-path", options->path, "Also write the scene's camera path")
      ->type_name("FILE.json");
  add_file_limits(*command, options->limits);
  command->footer("Example: rilievo scene 'bridge?triangles=100000' -o bridge.glb");
  return {command, [options](const std::string&) { return run_scene(*options); }};
}

}  // namespace rilievo::app

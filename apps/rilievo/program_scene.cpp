#include "apps/rilievo/program_scene.h"

#include <utility>

#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/save_glb.h"

namespace rilievo::app {

Result<ProgramScene> ProgramScene::create(const std::string& named, const FileLimits& limits,
                                          const Scene& shown) {
  ProgramScene made;
  made.file_ = named;
  if (!is_builtin(named) && !limits.up && !limits.metres_per_unit) return {std::move(made)};
  Result<ScratchFolder> folder = ScratchFolder::create("rilievo-scene");
  if (!folder) return folder.error();
  made.scratch_ = *std::move(folder);
  made.file_ = (made.scratch_.path() / "scene.glb").string();
  if (Result<> saved = save_glb(shown, made.file_); !saved) return saved.error();
  return {std::move(made)};
}

Result<ProgramScene> ProgramScene::create(const std::string& named, const FileLimits& limits,
                                          const Scene& shown, MethodOptions& options) {
  if (program_named(options.source).empty() || !options.program_scene.empty())
    return {ProgramScene()};
  Result<ProgramScene> made = create(named, limits, shown);
  if (made) options.program_scene = made->file();
  return made;
}

}  // namespace rilievo::app

#include "apps/rilievo/scene_file.h"

#include "apps/rilievo/output.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo::app {

Result<OpenedScene> open_scene(const std::string& text) {
  if (is_builtin(text)) {
    Result<BuiltinScene> built = make_builtin(text);
    if (!built) return built.error();
    return OpenedScene{std::move(built->scene), std::move(built->path)};
  }
  Result<LoadedScene> loaded = load_scene(text);
  if (!loaded) return loaded.error();
  for (const std::string& warning : loaded->warnings) complain(text + ": warning: " + warning);
  return OpenedScene{std::move(loaded->scene), {}};
}

}  // namespace rilievo::app

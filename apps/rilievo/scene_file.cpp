#include "apps/rilievo/scene_file.h"

#include "rilievo/scene/builtin.h"

namespace rilievo::app {

Result<OpenedScene> open_scene(const std::string& text) {
  if (is_builtin(text)) {
    Result<BuiltinScene> built = make_builtin(text);
    if (!built) return built.error();
    return OpenedScene{std::move(built->scene), std::move(built->path)};
  }
  return Error{text, "is not a built-in scene"};
}

}  // namespace rilievo::app

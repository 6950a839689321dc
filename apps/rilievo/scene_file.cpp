#include "apps/rilievo/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

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
  for (std::string warning : loaded->warnings) {
    std::replace(warning.begin(), warning.end(), '\n', ' ');
    fmt::print(stderr, "rilievo: {}: warning: {}\n", text, warning);
  }
  return OpenedScene{std::move(loaded->scene), {}};
}

}  // namespace rilievo::app

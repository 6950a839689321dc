// A scene as it is named on the command line: a file, or builtin:NAME[?triangles=N&seed=S].
#pragma once

#include <optional>
#include <string>

#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/scene/scene.h"

namespace rilievo::app {

inline constexpr char kSceneHelp[] =
    "A glTF, GLB, OBJ, PLY or STL file, or builtin:NAME[?triangles=N&seed=S]";

struct OpenedScene {
  Scene scene;
  std::optional<CameraPath> walk;  // a built-in scene brings its own
};

// Warnings of the loader go to the error output.
[[nodiscard]] Result<OpenedScene> open_scene(const std::string& text);

}  // namespace rilievo::app

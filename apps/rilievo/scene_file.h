// How is a scene named on the command line? As a file, or as builtin:NAME[?triangles=N&seed=S].
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

#include "rilievo/core/camera_path.h"
#include "rilievo/core/result.h"
#include "rilievo/scene/bend.h"
#include "rilievo/scene/point_size.h"
#include "rilievo/scene/scene.h"

namespace rilievo::app {

inline constexpr char kSceneHelp[] =
    "A glTF, GLB, OBJ, PLY or STL file, or builtin:NAME[?triangles=N&seed=S]";

struct OpenedScene {
  Scene scene;
  Deformations deformations;       // of a file, if asked for
  std::optional<CameraPath> walk;  // a built-in scene brings its own
};

// What may be spent on the files of strangers, where they may lead, and what they do not say.
struct FileLimits {
  int memory_mb = 4096;
  bool allow_outside = false;
  PointSize point_size;  // of clouds of points
  std::optional<UpAxis> up;
  std::optional<double> metres_per_unit;

  [[nodiscard]] std::uint64_t bytes() const { return std::uint64_t(memory_mb) << 20; }
};

// Fails if --up or --units was given for what is no file of a scene.
[[nodiscard]] Result<> expect_no_units(const std::string& text, const FileLimits& limits);

void add_file_limits(CLI::App& command, FileLimits& limits);

// Warnings of the loader go to the error output. Skins and morph targets are posed at `time`
// (seconds), or kept to be posed at any.
[[nodiscard]] Result<OpenedScene> open_scene(const std::string& text, const FileLimits& limits,
                                             double time = 0, bool deformations = false);

}  // namespace rilievo::app

// The ways to draw a scene, by the names they have on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "rilievo/capture/scene_renderer.h"
#include "rilievo/draw/frame_source.h"

namespace rilievo::app {

struct MethodOptions {
  int delta_bits = 8;
  std::string depth = "exact";
  bool outlines = false;
};

void add_method_options(CLI::App& command, MethodOptions& options);

// direct, flat, nailboard.
[[nodiscard]] const std::vector<std::string>& method_names();

// `renderer` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                               const MethodOptions& options,
                                                               SceneRenderer& renderer);

}  // namespace rilievo::app

// The ways to draw a scene, by the names they have on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "rilievo/capture/scene_renderer.h"
#include "rilievo/draw/frame_source.h"
#include "rilievo/represent/picture_geometry.h"

namespace rilievo::app {

struct MethodOptions {
  int delta_bits = 8;
  std::string depth = "exact";
  bool outlines = false;
  double angle_degrees = 0.7;  // flat, nailboard
  int memory_mb = 256;
  double error_px = 1;    // cache
  double capture_ms = 0;  // cache; 0: a budget by triangles
  bool fade = true;       // cache
};

void add_method_options(CLI::App& command, MethodOptions& options);

// Of nailboards: --depth.
[[nodiscard]] DepthMode depth_mode(const MethodOptions& options);

// direct, flat, nailboard, cache.
[[nodiscard]] const std::vector<std::string>& method_names();

// `renderer` must outlive the source.
// `samples` is the frame's antialiasing, which pictures share.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                               const MethodOptions& options,
                                                               int samples,
                                                               SceneRenderer& renderer);

}  // namespace rilievo::app

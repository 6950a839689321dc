// The ways to draw a scene, or a layered impostor from a file, by the names they have on the
// command line.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "apps/rilievo/layered_options.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

struct MethodOptions {
  int delta_bits = 8;
  std::string depth = "exact";
  bool outlines = false;
  double angle_degrees = 0.7;  // flat, nailboard
  int memory_mb = 256;
  double error_px = 1;            // cache
  double capture_ms = 0;          // cache; 0: a budget by triangles
  bool fade = true;               // cache
  int bake_mb = 0;                // cache; 0: bakes nothing
  LayeredBakeOptions bake;        // cache, layered
  std::string warp = "surfaces";  // cache, layered
  double texel_px = 4;            // layered
};

void add_method_options(CLI::App& command, MethodOptions& options);

// Of nailboards: --depth.
[[nodiscard]] DepthMode depth_mode(const MethodOptions& options);

// direct, flat, nailboard, cache, layered, layered-slices.
[[nodiscard]] const std::vector<std::string>& method_names();
// Those that draw a layered impostor from a file: the last two.
[[nodiscard]] const std::vector<std::string>& layered_method_names();
// The error, if it is not one of those, is `option`'s.
[[nodiscard]] Result<> expect_layered(const std::string& method, const std::string& option);

// `renderer` must outlive the source.
// `samples` is the frame's antialiasing, which pictures share.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                               const MethodOptions& options,
                                                               int samples,
                                                               SceneRenderer& renderer);

// Draws the impostor before the sky of `sky`'s scene. `sky` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_layered_source(const std::string& method,
                                                                       const MethodOptions& options,
                                                                       LayeredImpostor impostor,
                                                                       SceneRenderer& sky);

}  // namespace rilievo::app

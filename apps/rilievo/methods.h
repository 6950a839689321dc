// Which methods draw a scene, or the contents of a file, and what are they called on the command
// line?
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/rilievo/impostors.h"
#include "apps/rilievo/kinds.h"
#include "rilievo/cache/machine_costs.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

struct MethodOptions {
  std::string draw = "automatic";  // opengl, software; automatic: as is faster here
  int delta_bits = 8;
  std::string depth = "exact";
  bool outlines = false;
  double angle_degrees = 0.7;  // flat, nailboard
  int memory_mb = 256;
  double error_px = 1;    // cache
  double gap_px = 0;      // cache; 0: twice error_px
  bool levels = false;    // cache, without OpenGL: levels of detail
  double capture_ms = 0;  // cache; 0: a budget by triangles
  double max_spike = 0;   // cache; 0: no limit
  bool fade = true;       // cache
  int bake_mb = 0;        // cache; 0: bakes nothing
  std::vector<std::string> bake_as{
      std::string(default_kind().name)};  // cache: kinds that are baked
  std::optional<double> bake_beyond;      // cache: metres
  bool bake_together = false;             // cache: all that stands still as one
  double texel_px = 4;                    // kinds drawn for objects
  KindOptions kinds;
  ImpostorOptions impostors;                 // relief-impostor
  Box eyes = {};                             // where eyes will be; empty: not known
  std::optional<MachineCosts> machine = {};  // cache; none: the costs built in
};

void add_method_options(CLI::App& command, MethodOptions& options);

// Of nailboards: --depth.
[[nodiscard]] DepthMode depth_mode(const MethodOptions& options);

// direct, direct-raster, direct-rays, lod, flat, nailboard, cache, relief-impostor, and those of
// all kinds.
[[nodiscard]] const std::vector<std::string>& method_names();
// Does --method take it? Former names too.
[[nodiscard]] bool is_method(const std::string& name);
// Does the method show skins and morph targets by time, if it is given Deformations? direct-raster
// by software only.
[[nodiscard]] bool bends_by_time(const std::string& method);
// For CLI options that take one or several methods.
[[nodiscard]] CLI::Validator known_method();

// Can what a file of this kind holds be drawn by the method? The error is `option`'s.
[[nodiscard]] Result<> expect_method_of(const Kind& kind, const std::string& method,
                                        const std::string& option);

// Why a method's frames cannot be drawn without OpenGL; none: they can.
[[nodiscard]] std::optional<std::string> needs_opengl(const std::string& method,
                                                      const MethodOptions& options, int samples);
// Draws without OpenGL (FrameSource::software_target). `scene` must outlive the source. Fails where
// OpenGL is needed.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_source(
    const std::string& method, const MethodOptions& options, int samples, const Scene& scene);

// `renderer` must outlive the source. Draws without OpenGL if the options ask for it, or leave it
// open where OpenGL runs on processors and is not needed.
// `samples` is the frame's antialiasing, which pictures share.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_source(const std::string& method,
                                                               const MethodOptions& options,
                                                               int samples,
                                                               SceneRenderer& renderer);

// The same, for a program that may have no OpenGL: makes `context` and `renderer` unless the source
// draws without. They must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_scene_source(
    const std::string& method, const MethodOptions& options, int samples, const Scene& scene,
    std::unique_ptr<gl::Context>& context, std::optional<SceneRenderer>& renderer);

// The same without OpenGL, under the sky of a scene, which must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_stored_source(
    const std::string& method, const MethodOptions& options, int samples,
    std::unique_ptr<Representation> representation, const Scene& sky);

// Is what a file holds drawn without OpenGL: because the options ask for it, or leave it open where
// OpenGL runs on processors or there is none? The error, if OpenGL is asked for, is `missing`.
[[nodiscard]] Result<bool> draws_by_software(const std::string& method,
                                             const MethodOptions& options, int samples,
                                             bool has_opengl, const Error& missing);

// What a file holds, drawn under the sky of `sky`'s scene by a method of its kind. A drawable takes
// the representation for itself: one load for each source. `sky` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_stored_source(
    const std::string& method, const MethodOptions& options,
    std::unique_ptr<Representation> representation, SceneRenderer& sky);

}  // namespace rilievo::app

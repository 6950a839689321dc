// Which options does --method relief-impostor take?
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/scene/bend.h"

namespace rilievo::app {

struct ImpostorOptions {
  std::string shader = "raytrace";
  std::vector<std::string> objects;  // names, #INDEX; empty: all
  int workers = 1;
  std::string store;
  int store_mb = 4096;
  int texels = 1024;  // of a picture's longer side, at most
  int samples = 4;    // of a texel
  bool background = false;
  const Deformations* deformations = nullptr;  // of the scene; null: nothing bends
};

void add_impostor_options(CLI::App& command, ImpostorOptions& options);

// `renderer` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_impostor_frames(
    const ImpostorOptions& options, bool outlines, SceneRenderer& renderer);
// The same without OpenGL. `scene` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_impostor_frames(
    const ImpostorOptions& options, bool outlines, int samples, const Scene& scene);

}  // namespace rilievo::app

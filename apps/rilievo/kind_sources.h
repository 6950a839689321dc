// How does the command line draw a scene by a kind of representation, baked before the first frame?
//
// Surroundings: all that stands still by one bake, what moves as polygons. Objects: each heavy one
// by a bake of its own.
#pragma once

#include <memory>

#include "apps/rilievo/method_options.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

// Baked and drawn by OpenGL. `renderer` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_kind(const KindMethod& method,
                                                             const MethodOptions& options,
                                                             SceneRenderer& renderer);
// Baked by rays, and drawn without OpenGL. `scene` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_kind(const KindMethod& method,
                                                                      const MethodOptions& options,
                                                                      int samples,
                                                                      const Scene& scene);

}  // namespace rilievo::app

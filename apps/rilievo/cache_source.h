// How does the command line make the cache, and what is baked beforehand for it?
#pragma once

#include <memory>

#include "apps/rilievo/method_options.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

// Drawn and captured by OpenGL. `renderer` must outlive the source. The errors name options.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_cache(const MethodOptions& options,
                                                              int samples, SceneRenderer& renderer);
// The same without OpenGL. `scene` must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_cache(const MethodOptions& options,
                                                                       int samples,
                                                                       const Scene& scene);

}  // namespace rilievo::app

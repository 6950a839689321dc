// Which methods are no kind's? Those that draw from pictures that are captured while the eye moves,
// or from none.
#pragma once

#include <memory>
#include <span>

#include "apps/rilievo/method_options.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

// A method, and how each backend makes its source. What the source draws must outlive it.
struct BuiltinMethod {
  const char* name;
  Result<std::unique_ptr<FrameSource>> (*make)(const MethodOptions& options, int samples,
                                               SceneRenderer& renderer);
  Result<std::unique_ptr<FrameSource>> (*make_software)(const MethodOptions& options, int samples,
                                                        const Scene& scene);
};
[[nodiscard]] std::span<const BuiltinMethod> builtin_methods();

}  // namespace rilievo::app

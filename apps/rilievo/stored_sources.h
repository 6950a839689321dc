// How is what a file holds drawn by a method of its kind?
//
// A drawable takes the representation for itself: one load for each source.
#pragma once

#include <memory>
#include <string>

#include "apps/rilievo/method_options.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/representation/kinds.h"

namespace rilievo::app {

// Drawn by OpenGL under the sky of `sky`'s scene, which must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_stored_source(
    const std::string& method, const MethodOptions& options,
    std::unique_ptr<Representation> representation, SceneRenderer& sky);

// The same without OpenGL, under the sky of a scene, which must outlive the source.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_software_stored_source(
    const std::string& method, const MethodOptions& options, int samples,
    std::unique_ptr<Representation> representation, const Scene& sky);

}  // namespace rilievo::app

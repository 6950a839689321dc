// How does OpenGL capture every surface along each line of sight? By depth peeling (S4.1).
//
// Gives the same as render/rays/cast_layers.h, with the colours of direct drawing. Each pass draws
// what lies behind everything that earlier passes drew. Back faces count, too; those of a
// single-sided surface look like its front. One line of sight for each texel, through its centre.
// Needs a current OpenGL context; changes the bound framebuffer and viewport.
#pragma once

#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// Which surfaces become samples.
struct PeelOptions {
  // Surfaces within this distance along a line of sight become one, the nearest. Metres of eye_z.
  double merge = 0;
  int max_layers = 256;       // the largest number of samples on one line of sight
  float least_roughness = 0;  // smoother surfaces are shaded as if they were so rough
};

// Captures `objects` (indices into Scene::objects; opaque and masked parts) at the renderer's time.
// Depths are eye_z. Accepts parallel and perspective cameras.
[[nodiscard]] Result<LayeredDepthImage> capture_layers(SceneRenderer& renderer,
                                                       const Camera& camera,
                                                       std::span<const std::uint32_t> objects,
                                                       const PeelOptions& options = {});

}  // namespace rilievo

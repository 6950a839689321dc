// Every surface along each line of sight, by depth peeling (S4.1).
//
// The same as render/rays/cast_layers.h, with the colours of direct drawing: each pass draws what
// lies behind all that earlier passes drew. Back faces count, too; of a single-sided surface they
// look as its front does. One line of sight a texel, through its centre. Needs a current OpenGL
// context; changes the bound framebuffer and viewport.
#pragma once

#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

struct PeelOptions {
  // Of surfaces along a line of sight that lie closer together the nearest stays; metres of eye_z.
  double merge = 0;
  int max_layers = 256;  // no more samples than that on one line of sight
};

// Of `objects` (indices into Scene::objects; opaque and masked parts) at the renderer's time;
// eye_z. Takes parallel and perspective cameras.
[[nodiscard]] Result<LayeredDepthImage> capture_layers(SceneRenderer& renderer,
                                                       const Camera& camera,
                                                       std::span<const std::uint32_t> objects,
                                                       const PeelOptions& options = {});

}  // namespace rilievo

// How is a scene captured by OpenGL as a picture with depth, for a camera of any kind?
//
// For pictures that leave the GPU, to files, warps and measures. Pictures that stay on the GPU are
// captured by nailboard/gl/nailboard_atlas.h. Needs a current OpenGL context; changes the bound
// framebuffer and viewport.
#pragma once

#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// What to capture besides colour and depth.
struct CaptureOptions {
  int samples = 4;        // per texel; colours are averaged, alpha is coverage
  bool objects = true;    // capture object identifiers
  bool with_sky = false;  // otherwise texels without an object stay empty
};

// Captures `objects` (indices into Scene::objects; opaque and masked parts) at the renderer's time,
// in linear light. Depth is the eye_z of the nearest surface at the texel's centre, or of the
// farthest for a back-perspective camera. A texel whose centre shows nothing is empty. The indices
// refer to the renderer's scene.
[[nodiscard]] Result<DepthImage> capture_picture(SceneRenderer& renderer, const Camera& camera,
                                                 std::span<const std::uint32_t> objects,
                                                 const CaptureOptions& options = {});

// Captures everything that the camera sees.
[[nodiscard]] Result<DepthImage> capture_picture(SceneRenderer& renderer, const Camera& camera,
                                                 const CaptureOptions& options = {});

// The eye_z of the nearest surface of `objects` at the texels' centres; kNoDepth if there is none.
[[nodiscard]] Result<Image<float>> capture_nearest(SceneRenderer& renderer, const Camera& camera,
                                                   std::span<const std::uint32_t> objects);

// The eye_z of the farthest of all surfaces of `objects` along each texel's ray, including hidden
// ones and back faces (for a back-perspective camera the nearest); kNoDepth if there is none.
[[nodiscard]] Result<Image<float>> capture_farthest(SceneRenderer& renderer, const Camera& camera,
                                                    std::span<const std::uint32_t> objects);

}  // namespace rilievo

// Scene + Camera -> DepthImage, rasterised: a picture with depth in linear light, of any camera
// kind.
//
// What leaves the GPU here goes into files, warps and measures. Pictures that stay on the GPU are
// captured by nailboard/gl/picture_atlas.h instead. Needs a current OpenGL context; changes the
// bound framebuffer and viewport.
#pragma once

#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

struct CaptureOptions {
  int samples = 4;        // samples a texel; colours are averaged, alpha is coverage
  bool objects = true;    // identifiers too
  bool with_sky = false;  // else texels without an object stay empty
};

// The picture of `objects` (indices into Scene::objects; opaque and masked parts) at the renderer's
// time. Depth is eye_z at the texel's centre: the nearest surface's, or for back-perspective the
// farthest's; where only the centre misses, the texel is empty. Requires the renderer's own scene.
[[nodiscard]] Result<DepthImage> capture_picture(SceneRenderer& renderer, const Camera& camera,
                                                 std::span<const std::uint32_t> objects,
                                                 const CaptureOptions& options = {});

// The same of everything that the camera sees.
[[nodiscard]] Result<DepthImage> capture_picture(SceneRenderer& renderer, const Camera& camera,
                                                 const CaptureOptions& options = {});

// eye_z of the nearest surface of `objects` at the texels' centres; kNoDepth where there is none.
[[nodiscard]] Result<Image<float>> capture_nearest(SceneRenderer& renderer, const Camera& camera,
                                                   std::span<const std::uint32_t> objects);

// eye_z at the other end of each texel's ray: of the farthest of all surfaces of `objects`, hidden
// ones and back faces included (for back-perspective the nearest); kNoDepth where there is none.
[[nodiscard]] Result<Image<float>> capture_hindmost(SceneRenderer& renderer, const Camera& camera,
                                                    std::span<const std::uint32_t> objects);

}  // namespace rilievo

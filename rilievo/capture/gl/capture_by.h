// Who captures the pictures of a scene for an atlas of nailboards?
//
// Either OpenGL, into the atlas's own textures, so that pictures never leave the GPU; or, where
// OpenGL runs on the CPU, the library's own rasteriser, which hands its pictures to the atlas.
// Numbers of samples that the rasteriser does not support are left to OpenGL. Needs a current
// OpenGL context.
#pragma once

#include <memory>

#include "rilievo/capture/capture_without_opengl.h"

namespace rilievo {

// Null if OpenGL is to capture. `scene` must be valid and outlive what is returned.
[[nodiscard]] std::unique_ptr<CaptureWithoutOpenGL> make_capturer(CaptureBy by, const Scene& scene,
                                                                  int samples);

}  // namespace rilievo

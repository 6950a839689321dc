// How is a layered impostor made of a scene's objects?
//
// By capturing them from every direction of a view set (S2.1, S2.2), and by finding the slices
// that fill each view's holes (S2.6). Needs a current OpenGL context; changes the bound framebuffer
// and viewport.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "rilievo/capture/gl/capture_picture.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

struct BakeOptions {
  ViewSetOptions views;
  ViewCameraOptions camera;
  SliceOptions slicing;
  int samples = 4;                                    // a texel
  bool fills = true;                                  // look for the slices that fill holes
  std::function<void(int done, int total)> progress;  // in pictures captured, if given
};

// Of `objects` (indices into Scene::objects; opaque and masked parts) at the renderer's time, in
// world space. Nothing if they have no opaque parts or no extent.
[[nodiscard]] Result<LayeredImpostor> bake_layered(SceneRenderer& renderer,
                                                   std::span<const std::uint32_t> objects,
                                                   const BakeOptions& options = {});

// The same of the whole scene.
[[nodiscard]] Result<LayeredImpostor> bake_layered(SceneRenderer& renderer,
                                                   const BakeOptions& options = {});

}  // namespace rilievo

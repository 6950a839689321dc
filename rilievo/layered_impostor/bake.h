// How is a layered impostor made of a scene's objects?
//
// Captures them from each direction of a view set (S2.1, S2.2), then finds the slices that fill
// each view's holes (S2.6).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "rilievo/capture/capture_source.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// The views, the slicing, and the quality of captures.
struct BakeOptions {
  ViewSetOptions views;
  ViewCameraOptions camera;
  SliceOptions slicing;
  int samples = 4;                                    // per texel
  bool fills = true;                                  // find the slices that fill holes
  std::function<void(int done, int total)> progress;  // called with numbers of pictures captured
};

// Bakes `objects` (indices into the scene's objects; empty: all), in world space. The error says
// what is missing: opaque parts, an extent.
[[nodiscard]] Result<LayeredImpostor> bake_layered(CaptureSource& source,
                                                   std::span<const std::uint32_t> objects,
                                                   const BakeOptions& options = {});

}  // namespace rilievo

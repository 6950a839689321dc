// How is a layered impostor made of a scene's objects?
//
// By capturing them from every direction of a view set (S2.1, S2.2), and by finding the slices
// that fill each view's holes (S2.6).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "rilievo/capture/capture_source.h"
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

// Of `objects` (indices into the scene's objects; empty: all), in world space. The error says what
// is missing: opaque parts, an extent.
[[nodiscard]] Result<LayeredImpostor> bake_layered(CaptureSource& source,
                                                   std::span<const std::uint32_t> objects,
                                                   const BakeOptions& options = {});

}  // namespace rilievo

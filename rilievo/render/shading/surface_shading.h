// What colour has a lit surface?
//
// The second half of the shading model (shading_model.inl), SIMD over surfaces: lights and sky.
// Linear light in; directions in world axes. The same bytes for any instruction set. Pure; any
// thread.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "rilievo/render/shading/surface.h"

namespace rilievo {

// A structure of arrays; the first `count` entries are to be shaded.
struct Surfaces {
  static constexpr std::size_t kMaxCount = 256;
  static constexpr std::size_t kCapacity = kMaxCount + 16;  // vectors are stored whole
  enum Field {
    base_r,
    base_g,
    base_b,
    normal_x,
    normal_y,
    normal_z,  // of any length, towards the side that is seen
    relative_x,
    relative_y,
    relative_z,  // position relative to the eye, metres
    view_x,
    view_y,
    view_z,  // the way to who sees it, unit
    emissive_r,
    emissive_g,
    emissive_b,
    roughness,
    metallic,
    occlusion,  // the share of the sky's light that arrives
    lit,        // 1; or 0: the base colour as it is
    kFields
  };
  std::size_t count = 0;
  alignas(64) float field[kFields][kCapacity];
};

struct SurfaceColors {
  alignas(64) float rgb[3][Surfaces::kMaxCount];
};

enum class ColorScale {
  linear,  // as much light as there is
  srgb,    // encoded, in [0, 1]
};

void shade_surfaces(const SurfaceLights& lights, const Surfaces& surfaces, ColorScale scale,
                    SurfaceColors& colors);

}  // namespace rilievo

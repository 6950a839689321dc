// The colour of a lit surface.
//
// The second half of the shading model (shading_model.inl), SIMD over surfaces: lights and sky.
// Input is in linear light, directions are in world axes. The result does not depend on the
// instruction set. Pure; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/render/shading/surface.h"

namespace rilievo {

// Surfaces to shade, as a structure of arrays with `count` valid entries.
struct Surfaces {
  static constexpr std::size_t kMaxCount = 256;
  static constexpr std::size_t kCapacity = kMaxCount + 16;  // vectors are stored whole
  enum Field {
    base_r,
    base_g,
    base_b,
    normal_x,
    normal_y,
    normal_z,  // of any length, towards the visible side
    relative_x,
    relative_y,
    relative_z,  // position relative to the eye, metres
    view_x,
    view_y,
    view_z,  // direction to the viewer, unit
    emissive_r,
    emissive_g,
    emissive_b,
    roughness,
    metallic,
    occlusion,  // the share of the sky's light that arrives
    lit,        // 1; 0: the colour is the base colour
    alpha,      // 1 unless the material blends; does not change the colour
    kFields
  };
  std::size_t count = 0;
  alignas(64) float field[kFields][kCapacity];
};

// The colours of Surfaces.
struct SurfaceColors {
  alignas(64) float rgb[3][Surfaces::kMaxCount];
};

// The encoding of the result.
enum class ColorScale {
  linear,  // linear light, not limited
  srgb,    // encoded, in [0, 1]
};

// Shades all surfaces.
void shade_surfaces(const SurfaceLights& lights, const Surfaces& surfaces, ColorScale scale,
                    SurfaceColors& colors);

// Their bytes, premultiplied by alpha (Surfaces::alpha, limited to [0, 1]), the first one in the
// lowest bits, alpha in the highest; one entry for each surface. Requires colours of
// ColorScale::srgb, and room for Surfaces::kMaxCount in `bytes`.
void premultiplied_bytes(const Surfaces& surfaces, const SurfaceColors& colors,
                         std::uint32_t* bytes);

}  // namespace rilievo

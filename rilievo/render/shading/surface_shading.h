// What colour has a lit surface, as render/opengl/scene_shaders.h shades it?
//
// Metallic-roughness shading after appendix B of the glTF 2.0 specification, the light of a clear
// sky, and sRGB at the end: the same formulas for processors, SIMD over surfaces. Linear light in,
// sRGB out; directions in world axes. The same bytes for any instruction set. Pure; any thread.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "rilievo/scene/scene.h"

namespace rilievo {

// A structure of arrays; the first `count` entries are to be shaded.
struct Surfaces {
  static constexpr std::size_t kMost = 256;
  static constexpr std::size_t kRoom = kMost + 16;  // vectors are stored whole
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
    emissive_r,
    emissive_g,
    emissive_b,
    roughness,
    metallic,
    lit,  // 1; or 0: the base colour as it is
    kFields
  };
  std::size_t count = 0;
  alignas(64) float field[kFields][kRoom];
};

// In [0, 1].
struct SurfaceColors {
  alignas(64) float srgb[3][Surfaces::kMost];
};

// The lights of a Scene as an eye at `eye` (world) needs them.
struct SurfaceLights {
  std::span<const Light> lights;  // not empty
  glm::dvec3 eye{0.0};
  Sky sky;
};

void shade_surfaces(const SurfaceLights& lights, const Surfaces& surfaces, SurfaceColors& colors);

}  // namespace rilievo

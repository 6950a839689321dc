// sRGB at the edges (IEC 61966-2-1), linear light inside; premultiplied alpha throughout.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/image.h"

namespace rilievo {

[[nodiscard]] float srgb_from_linear(float linear);
[[nodiscard]] float linear_from_srgb(float srgb);

using Rgba8Image = Image<glm::u8vec4>;

// 8-bit sRGB for files and screens; colours are clamped to [0, 1]; alpha is stored as it is.
[[nodiscard]] Rgba8Image srgb8_from_linear(const ColorImage& linear);
[[nodiscard]] ColorImage linear_from_srgb8(const Rgba8Image& srgb);

}  // namespace rilievo

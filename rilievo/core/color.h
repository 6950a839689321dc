// Colours, from files to linear light and back.
//
// Files and frames are 8-bit sRGB (IEC 61966-2-1). Inside, colours are linear, with premultiplied
// alpha.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/image.h"

namespace rilievo {

// The transfer function of sRGB, and its inverse, for one channel in [0, 1].
[[nodiscard]] float srgb_from_linear(float linear);
[[nodiscard]] float linear_from_srgb(float srgb);
// The same of i / 255, for each byte i.
[[nodiscard]] const std::array<float, 256>& linear_of_srgb_bytes();

// 8-bit sRGB and alpha, as files and screens have them.
using Rgba8Image = Image<glm::u8vec4>;

// Converts a picture; alpha stays as it is. Colours above 1 and below 0 are clamped in 8 bits.
[[nodiscard]] Rgba8Image srgb8_from_linear(const ColorImage& linear);
[[nodiscard]] ColorImage linear_from_srgb8(const Rgba8Image& srgb);

}  // namespace rilievo

#include "rilievo/core/color.h"

#include <algorithm>
#include <cmath>

namespace rilievo {

float srgb_from_linear(float linear) {
  if (linear <= 0.0031308f) return 12.92f * linear;
  return 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float srgb) {
  if (srgb <= 0.04045f) return srgb / 12.92f;
  return std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

const std::array<float, 256>& linear_of_srgb_bytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < 256; ++i) linear[i] = linear_from_srgb(float(i) / 255.0f);
    return linear;
  }();
  return table;
}

Rgba8Image srgb8_from_linear(const ColorImage& linear) {
  Rgba8Image out(linear.width(), linear.height());
  const auto byte = [](float v) { return std::uint8_t(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f); };
  for (std::size_t i = 0; i < linear.texels().size(); ++i) {
    const glm::vec4& c = linear.texels()[i];
    out.texels()[i] = {byte(srgb_from_linear(std::max(c.r, 0.0f))),
                       byte(srgb_from_linear(std::max(c.g, 0.0f))),
                       byte(srgb_from_linear(std::max(c.b, 0.0f))), byte(c.a)};
  }
  return out;
}

ColorImage linear_from_srgb8(const Rgba8Image& srgb) {
  const std::array<float, 256>& table = linear_of_srgb_bytes();
  ColorImage out(srgb.width(), srgb.height());
  for (std::size_t i = 0; i < srgb.texels().size(); ++i) {
    const glm::u8vec4& c = srgb.texels()[i];
    out.texels()[i] = {table[c.r], table[c.g], table[c.b], float(c.a) / 255.0f};
  }
  return out;
}

}  // namespace rilievo

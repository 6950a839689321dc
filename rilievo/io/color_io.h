// How are vertex colours of files converted? Internal to loading.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/color.h"

namespace rilievo {

// A linear colour from the sRGB values that scanners and sculpting programs write. Alpha is
// unchanged.
[[nodiscard]] inline glm::vec4 linear_from_screen(const glm::dvec4& c) {
  return {linear_from_srgb(float(c.r)), linear_from_srgb(float(c.g)), linear_from_srgb(float(c.b)),
          float(c.a)};
}

}  // namespace rilievo

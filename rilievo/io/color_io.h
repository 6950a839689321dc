// Vertex colours as files have them. Internal to loading.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/color.h"

namespace rilievo {

// Scanners and sculpting programs write what a screen shows; alpha stays as it is.
[[nodiscard]] inline glm::vec4 linear_from_screen(const glm::dvec4& c) {
  return {linear_from_srgb(float(c.r)), linear_from_srgb(float(c.g)), linear_from_srgb(float(c.b)),
          float(c.a)};
}

}  // namespace rilievo

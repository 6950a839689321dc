// A frame that is worse by a known measure.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rilievo/core/color.h"

namespace rilievo {

// All channels of colour by so many steps of a byte.
inline Rgba8Image darker(Rgba8Image color, int by) {
  for (glm::u8vec4& one : color.texels())
    for (int k = 0; k < 3; ++k) one[k] = std::uint8_t(std::max(0, int(one[k]) - by));
  return color;
}

}  // namespace rilievo

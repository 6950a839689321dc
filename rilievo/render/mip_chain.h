// A texture seen from a distance: its mip levels.
//
// Each level is half as wide and high as the one before (rounded down, at least 1), down to a
// single texel. A texel is the average of the area that it covers, in linear light, and of a mask's
// texture the average of what passes there. Level 0 is the texture itself and not stored again. The
// result does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/color.h"

namespace rilievo {

// The levels of a texture after level 0.
struct MipChain {
  // The size and the place of a level.
  struct Level {
    int width = 0, height = 0;  // texels
    std::size_t offset = 0;     // of its first texel in `texels`; unused for level 0
  };
  std::vector<Level> levels;  // the first one is the texture
  std::vector<glm::u8vec4> texels;

  [[nodiscard]] std::size_t bytes() const { return texels.size() * sizeof(texels[0]); }
};

// What the color of a texel is the average of.
enum class MipColors {
  of_all,         // each texel counts by its area
  of_what_shows,  // each also by its alpha: what a mask cuts away gives no color
};

// Computes the levels. `srgb`: red, green and blue are sRGB-encoded (alpha never is).
[[nodiscard]] MipChain build_mip_chain(const Rgba8Image& texture, bool srgb,
                                       MipColors colors = MipColors::of_all);

}  // namespace rilievo

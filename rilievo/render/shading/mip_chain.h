// What does a texture look like from afar?
//
// Its smaller levels, each half as wide and high as the one before (rounded down, at least 1), down
// to a single texel: a texel is the average of the area that it covers, in linear light. Level 0 is
// the texture itself and not kept again. The same bytes for any number of threads.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/core/color.h"

namespace rilievo {

struct MipChain {
  struct Level {
    int width = 0, height = 0;
    std::size_t offset = 0;  // of its first texel in `texels`; of level 0: 0, in the texture
  };
  std::vector<Level> levels;  // the first one is the texture
  std::vector<glm::u8vec4> texels;

  [[nodiscard]] std::size_t bytes() const { return texels.size() * sizeof(texels[0]); }
};

// `srgb`: are red, green and blue encoded? Alpha never is.
[[nodiscard]] MipChain build_mip_chain(const Rgba8Image& texture, bool srgb);

}  // namespace rilievo

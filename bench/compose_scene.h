// Which pictures does `bench compose` draw? Those of no scene: boxes and foliage all over a frame.
#pragma once

#include <vector>

#include "rilievo/nailboard/nailboard.h"

namespace rilievo::bench {

// 1280 x 720, at the origin.
[[nodiscard]] Camera compose_frame();

// `count` pictures of 12 to 310 pixels a side, half of them foliage, texel on pixel, whose boxes
// cover the frame `cover` times; each captured 1 degree off the line from the frame's eye.
[[nodiscard]] std::vector<Nailboard> compose_pictures(int count, double cover, int delta_bits);

// `count` balls of 16 x 16 texels, near and far, all over the frame.
[[nodiscard]] std::vector<Nailboard> compose_balls(int count, int delta_bits);

}  // namespace rilievo::bench

// The frames that the tests of PSNR, SSIM and FLIP compare. tests/reference/image_quality.py makes
// the same ones, with the same integers.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rilievo/core/color.h"

namespace rilievo {

// A hash of four integers (lowbias32).
inline std::uint32_t scramble(std::uint32_t x, std::uint32_t y, std::uint32_t c,
                              std::uint32_t seed) {
  std::uint32_t h = x * 73856093u ^ y * 19349663u ^ c * 83492791u ^ seed * 2654435761u;
  h ^= h >> 16;
  h *= 0x7FEB352Du;
  h ^= h >> 15;
  h *= 0x846CA68Bu;
  return h ^ h >> 16;
}

struct FramePair {
  Rgba8Image a, b;
};

// Blocks of 8 pixels with a gradient; and the same with noise and some other blocks.
inline FramePair frame_pair(int width, int height, std::uint32_t seed) {
  FramePair out{Rgba8Image(width, height), Rgba8Image(width, height)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto u = std::uint32_t(x), v = std::uint32_t(y);
      const bool changed = scramble(u >> 4, v >> 4, 0, seed + 2) % 8 == 0;
      for (int c = 0; c < 3; ++c) {
        const int block = int(scramble(u >> 3, v >> 3, std::uint32_t(c), seed) % 200);
        const int noise = int(scramble(u, v, std::uint32_t(c), seed + 1) % 31) - 15;
        const int value = block + (x + 2 * y) % 56;
        out.a(x, y)[c] = std::uint8_t(value);
        out.b(x, y)[c] = std::uint8_t(std::clamp(value + noise + 60 * int(changed), 0, 255));
      }
      out.a(x, y).a = out.b(x, y).a = 255;
    }
  return out;
}

}  // namespace rilievo

// How far is one frame from another? For tests.
#pragma once

#include <cmath>
#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/core/image.h"

namespace rilievo {

inline double psnr_of(const Rgba8Image& a, const Rgba8Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double d = double(a.texels()[i][c]) - double(b.texels()[i][c]);
      sum += d * d;
    }
  return sum == 0 ? 100 : 10 * std::log10(255.0 * 255.0 * 3 * double(a.texels().size()) / sum);
}

// The share of pixels whose object is none of those that the other frame shows at the pixel and its
// neighbours: an edge may be a pixel off.
inline double wrong_share(const Image<std::uint32_t>& a, const Image<std::uint32_t>& b) {
  int wrong = 0;
  for (int y = 1; y + 1 < a.height(); ++y)
    for (int x = 1; x + 1 < a.width(); ++x) {
      bool found = false;
      for (int i = 0; i < 9; ++i) found = found || b(x - 1 + i % 3, y - 1 + i / 3) == a(x, y);
      wrong += !found;
    }
  return double(wrong) / (a.width() * a.height());
}

}  // namespace rilievo

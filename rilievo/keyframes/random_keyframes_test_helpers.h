// Keyframes of nothing in particular, for tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/random.h"
#include "rilievo/keyframes/keyframe.h"

namespace rilievo {

// Most show their texel's surface.
inline std::uint32_t random_quarter(Random& random) {
  const int shows = std::max(0, int(random.between(-6, 2.99)));
  const int same = int(random.between(0, 4.99));
  return quarter_code(Quarter(shows), std::uint32_t(same),
                      std::uint32_t(random.between(0, 4.99 - same)));
}

// A picture of random patches at random depths, some of them sky. `steep`: of patches whose depths
// differ by up to 2.9 % from texel to texel.
inline Keyframe random_keyframe(Random& random, const Camera& camera, bool quarters,
                                bool steep = false) {
  Keyframe key;
  resize(key, camera, quarters);
  std::fill(key.inverse_z.texels().begin(), key.inverse_z.texels().end(), 0.02f);
  for (int i = 0; i < 40; ++i) {
    const int x0 = int(random.between(0, camera.width)), y0 = int(random.between(0, camera.height));
    const int wide = int(random.between(1, 30)), high = int(random.between(1, 30));
    const bool sky = random.between(0, 1) < 0.2;
    const double depth = random.between(2, 40), slope = random.between(-0.004, 0.004);
    const double across = steep ? random.between(-0.029, 0.029) : 0,
                 down = steep ? random.between(-0.029, 0.029) : 0;
    for (int y = y0; y < std::min(y0 + high, camera.height); ++y)
      for (int x = x0; x < std::min(x0 + wide, camera.width); ++x) {
        const double w = steep ? std::exp(across * (x - x0) + down * (y - y0)) / depth
                               : 1 / depth + slope * (x - x0) / wide;
        key.inverse_z(x, y) = sky ? 0.0f : float(w);
        key.object(x, y) = sky ? kNoObject : std::uint32_t(i + 1);
      }
  }
  for (std::uint32_t& color : key.color.texels())
    color = std::uint32_t(random.between(0, double(1 << 24))) |
            (quarters ? random_quarter(random) : kWholeTexel);
  find_ranges(key, 0, camera.width);
  return key;
}

// `apart`: how far eyes differ; 1: by half a metre, and turned.
inline Camera random_eye(Random& random, int width, int height, double apart = 1) {
  const auto some = [&](double size) {
    return apart * glm::dvec3(random.between(-size, size), random.between(-size, size),
                              random.between(-size, size));
  };
  const glm::dvec3 eye = some(0.5);
  return look_at(eye, eye + glm::dvec3(0, 0, -10) + some(1.5), {some(0.2).x, 1, 0}, 0.9, width,
                 height, 0.1, 100);
}

}  // namespace rilievo

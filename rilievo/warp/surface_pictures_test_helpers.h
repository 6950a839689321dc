// For tests of surfaces of texels: pictures with holes and steps.
#pragma once

#include <random>

#include "rilievo/core/depth_image.h"

namespace rilievo::test_surfaces {

// A wall before the camera, slanted, with `holes` squares of 3 x 3 texels lost.
inline DepthImage wall(Projection projection, int size, int holes, std::mt19937& rng) {
  DepthImage picture;
  picture.camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, size, size, 1, 20);
  picture.camera.projection = projection;
  picture.color = ColorImage(size, size, glm::vec4(1));
  picture.depth = Image<float>(size, size, kNoDepth);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      picture.depth(x, y) = 4.0f + 2.0f * float(x) / float(size) + 1.0f * float(y) / float(size);
  std::uniform_int_distribution<int> place(0, size - 4);
  for (int i = 0; i < holes; ++i) {
    const int u = place(rng), v = place(rng);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) picture.depth(u + x, v + y) = kNoDepth;
  }
  return picture;
}

// Depths as sensors give them: steps everywhere, a tenth of all texels lost.
inline DepthImage noisy(Projection projection, int size, std::mt19937& rng) {
  DepthImage picture = wall(projection, size, 0, rng);
  std::uniform_real_distribution<float> u(0, 1);
  for (float& d : picture.depth.texels()) d = u(rng) < 0.1f ? kNoDepth : d + 0.2f * u(rng);
  return picture;
}

}  // namespace rilievo::test_surfaces

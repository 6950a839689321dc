// A picture of noise.
#pragma once

#include <random>

#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

// 40 x 33 texels, some of them empty, the outermost all of them; opaque.
inline Nailboard random_board(std::mt19937& rng, int bits) {
  std::uniform_real_distribution<float> u(-1, 1);
  Box box;
  box.add(glm::vec3(-1)), box.add(glm::vec3(1.0f, 0.6f, 0.8f));
  Camera camera = *tight_camera(Projection::perspective, {u(rng), 1 + u(rng), 5}, {0, 1, 0}, box);
  camera.width = 40, camera.height = 33;
  Nailboard board;
  board.geometry = picture_geometry(camera);
  board.geometry.delta_bits = bits;
  board.color = Rgba8Image(40, 33);
  board.delta = Image<std::uint16_t>(40, 33, std::uint16_t(delta_transparent(bits)));
  for (int y = 1; y < 32; ++y)
    for (int x = 1; x < 39; ++x) {
      if (rng() % 6 == 0) continue;
      board.delta(x, y) = std::uint16_t(rng() % delta_transparent(bits));
      board.color(x, y) = glm::u8vec4(rng() % 256, rng() % 256, rng() % 256, 255);
    }
  return board;
}

}  // namespace rilievo

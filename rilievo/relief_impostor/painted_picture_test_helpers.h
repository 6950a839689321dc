// Pictures by formula, for tests and measurements.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "rilievo/relief_impostor/impostor_picture.h"

namespace rilievo {

// A texel of a painted picture; `depth` is window_z.
struct Paint {
  glm::u8vec4 color;
  double depth = 0;
};

// A picture of width x height texels from four metres in front of the origin. `paint(u, v)` gives
// the texel there, u and v from -1 to 1, as std::optional<Paint>; none: it is empty.
template <class PaintAt>
[[nodiscard]] ImpostorPicture painted_picture(int width, int height, PaintAt&& paint) {
  Nailboard board;
  board.geometry =
      picture_geometry(look_at({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.5, width, height, 3.0, 5.0));
  board.geometry.delta_bits = kLevelBits;
  board.color = Rgba8Image(width, height);
  board.delta = Image<std::uint16_t>(width, height, std::uint16_t(kEmptyLevel));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (const std::optional<Paint> texel =
              paint((2 * x + 1.0) / width - 1, (2 * y + 1.0) / height - 1)) {
        board.color(x, y) = texel->color;
        board.delta(x, y) =
            std::uint16_t(encode_delta(float(std::min(texel->depth, 1.0)), kLevelBits));
      }
  return impostor_picture(board);
}

}  // namespace rilievo

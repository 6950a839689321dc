// The result of a pre-warp: a nailboard as if captured by the eye that it was made for.
//
// Its camera stands at the eye and looks perpendicularly at the plane of the source picture. Any
// nailboard drawer draws it, from this eye without parallax.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/picture_geometry.h"

namespace rilievo {

// The picture. Planes are in row order with the size of `geometry.capture`. As a Nailboard's,
// except that no empty texel has a Delta.
struct Prewarped {
  PictureGeometry geometry;
  std::vector<glm::u8vec4> color;
  std::vector<std::uint16_t> delta;
  [[nodiscard]] int width() const { return geometry.capture.width; }
  [[nodiscard]] int height() const { return geometry.capture.height; }
};

}  // namespace rilievo

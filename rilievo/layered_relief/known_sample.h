// A sample of a picture with what is known of its surface, and those beside it. For pictures that
// share samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "rilievo/core/depth_image.h"
#include "rilievo/layered_relief/sample_sides.h"

namespace rilievo {

// Texels within which a sample of another picture is of the same surface: lines of sight hit it
// within 0.87 of any point (farthest_from_hits), and this one lies up to as far from its texel's
// middle.
inline constexpr double kOneSurface = 1.25;

// A sample with what is known of it.
struct KnownSample {
  LayerSample sample;
  glm::vec3 normal{0};
  float faces = 0;  // the cosine at which its picture sees it
  std::uint32_t source = 0;
  bool inner = false;  // of a closed object
  bool sure = true;    // of its normal
  bool sheet = false;  // not of a closed object: its other side is seen, too
};

[[nodiscard]] inline KnownSample known_of(const SampleSides& sides, std::uint32_t source,
                                          std::size_t s) {
  const glm::vec3 forward(sides.layers().camera.forward());
  return {sides.layers().samples[s], sides.normal(s), -glm::dot(sides.normal(s), forward), source,
          sides.is_inner(s),
          // Of what is not closed both sides are seen: what is not sure stays as it is.
          sides.knows_normal(s) || !sides.is_closed(s), !sides.is_closed(s)};
}

[[nodiscard]] inline double largest_texel(const Camera& camera) {
  return std::max((camera.window.right - camera.window.left) / camera.width,
                  (camera.window.top - camera.window.bottom) / camera.height);
}

// Calls visit(line, squared distance) for the line of sight and those around it that are within
// `reach` metres, from middle to middle.
template <class Visit>
void each_line_around(const Camera& camera, std::size_t line, double reach, const Visit& visit) {
  const int x0 = int(line % std::size_t(camera.width)), y0 = int(line / std::size_t(camera.width));
  for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, camera.height - 1); ++y)
    for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, camera.width - 1); ++x) {
      const double across = (x - x0) * (camera.window.right - camera.window.left) / camera.width;
      const double up = (y - y0) * (camera.window.top - camera.window.bottom) / camera.height;
      const double aside = across * across + up * up;
      if (aside <= reach * reach)
        visit(std::size_t(y) * std::size_t(camera.width) + std::size_t(x), aside);
    }
}

}  // namespace rilievo

// Pictures in front of a camera, for tests of what draws them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

// A blob with a soft edge and, perhaps, holes like foliage; smooth colours. The capture eye is
// within a few degrees of the frame's eye, as seen from what the picture shows.
inline Nailboard random_picture(Random& random, const Camera& frame, int delta_bits,
                                float most_px) {
  const double z = 4 * std::pow(8.0, random.unit());
  const glm::dvec3 middle = world_from_raster(
      frame,
      {frame.width * random.between(0.05f, 0.95f), frame.height * random.between(0.05f, 0.95f)}, z);
  const glm::dvec3 offset(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  const glm::dvec3 eye = frame.position() + 0.05 * z * offset;
  const double size_px = most_px * std::pow(10.0, -random.unit());
  const double distance = glm::length(middle - eye),
               radius = 0.5 * size_px * texel_angle(frame) * z;
  const int texels = std::max(4, int(size_px * random.between(0.6f, 1.3f)));
  const Camera capture =
      look_at(eye, middle, {0.1 * random.between(-1, 1), 1, 0.05}, 2 * std::atan(radius / distance),
              texels, std::max(4, int(float(texels) * random.between(0.5f, 1))), distance - radius,
              distance + radius);
  Nailboard board;
  board.geometry = picture_geometry(capture);
  board.geometry.delta_bits = delta_bits;
  board.color = Rgba8Image(capture.width, capture.height);
  board.delta = Image<std::uint16_t>(capture.width, capture.height,
                                     std::uint16_t(delta_transparent(delta_bits)));
  const bool foliage = random.below(2) == 0, full = random.below(6) == 0;
  const std::uint64_t seed = random.next();
  const auto alpha = [&](int x, int y) {
    if (full) return 1.0f;
    if (x <= 0 || y <= 0 || x >= capture.width - 1 || y >= capture.height - 1) return 0.0f;
    const float u = 2 * (float(x) + 0.5f) / float(capture.width) - 1,
                v = 2 * (float(y) + 0.5f) / float(capture.height) - 1;
    const float n = noise({float(x) / 5, float(y) / 5, 0}, seed);
    const float inside = foliage ? 0.75f - std::hypot(u, v) + 0.8f * n
                                 : 4 * (0.85f - std::max(std::abs(u), std::abs(v))) + 0.5f * n;
    return std::clamp(std::round(4 * (2 * inside + 0.5f)) / 4, 0.0f, 1.0f);  // of 4 samples
  };
  for (int y = 0; y < capture.height; ++y)
    for (int x = 0; x < capture.width; ++x) {
      const float a = alpha(x, y);
      bool beside = false;
      for (int k = 0; k < 9; ++k) beside = beside || alpha(x + k % 3 - 1, y + k / 3 - 1) > 0;
      if (!beside) continue;
      const float h = noise({float(x) / 9, float(y) / 9, 3}, seed);
      board.delta(x, y) = std::uint16_t(encode_delta(0.5f + 0.45f * h, delta_bits));
      if (a == 0) continue;
      for (int k = 0; k < 3; ++k) {
        const float c = 0.5f + 0.5f * noise({float(x) / 12, float(y) / 12, 5.0f + float(k)}, seed);
        board.color(x, y)[k] = std::uint8_t(std::lround(255 * a * c));
      }
      board.color(x, y).a = std::uint8_t(std::lround(255 * a));
    }
  return board;
}

// A camera among them.
inline Camera random_frame(Random& random, int width, int height) {
  const glm::dvec3 eye(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
  return look_at(1000.0 * eye, 1000.0 * eye + glm::dvec3(random.between(-1, 1), 0.2, -1), {0, 1, 0},
                 0.8, width, height, 0.5, 200);
}

}  // namespace rilievo

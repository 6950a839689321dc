// A thin red cable before a green wall: how wide is the widest gap that a frame shows along it?
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <utility>

#include "rilievo/capture/plate_test_helpers.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/scene/scene.h"

namespace rilievo::test_cable {

inline constexpr int kWidth = 160, kHeight = 120;

// It runs through (0, 0, 1), a metre before the wall on z = 0.
struct Cable {
  double half_length = 1.2, width = 0;  // metres; square across
  double angle = 0;                     // against x, in a plane of one z

  [[nodiscard]] glm::dvec3 end(double side) const {
    return {side * half_length * std::cos(angle), side * half_length * std::sin(angle), 1};
  }
};

// Sees the cable; a pixel is 0.0134 m wide where the cable is, and up to a tenth more.
inline Camera camera_at(const glm::dvec3& eye) {
  return look_at(eye, {0, 0, 0.5}, {0, 1, 0}, 0.75, kWidth, kHeight, 0.1, 50);
}

// Object 1 is the cable, 2 the wall, of 8 m. Both shine alike from everywhere.
inline Scene scene_of(const Cable& cable) {
  Scene scene;
  test_plate::add_red_and_green(scene);
  Mesh box, wall = test_plate::square(4);
  const glm::dvec3 along = cable.end(1) - glm::dvec3(0, 0, 1);
  const glm::dvec3 across = 0.5 * cable.width * glm::normalize(glm::dvec3(-along.y, along.x, 0)),
                   deep(0, 0, 0.5 * cable.width);
  // In pieces, since light objects are drawn as polygons.
  constexpr int kPieces = 50;
  for (int i = 0; i <= kPieces; ++i)
    for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      box.positions.emplace_back(glm::dvec3(0, 0, 1) + (2.0 * i / kPieces - 1) * along +
                                 double(u) * across + double(v) * deep);
  for (std::uint32_t i = 0; i < 4 * kPieces; ++i) {
    const std::uint32_t next = i % 4 == 3 ? i - 3 : i + 1;
    for (const std::uint32_t corner : {i, i + 4, next + 4, i, next + 4, next})
      box.indices.push_back(corner);
  }
  for (const std::uint32_t first : {0u, 4u * kPieces})
    for (const std::uint32_t corner : {0, 1, 2, 0, 2, 3}) box.indices.push_back(first + corner);
  box.material = 0, wall.material = 1;
  scene.meshes = {box, wall};
  scene.models = {{"cable", {{0, glm::mat4(1)}}, {}, 0}, {"wall", {{1, glm::mat4(1)}}, {}, 0}};
  scene.objects.resize(2);
  scene.objects[1].model = 1;
  finish(scene);
  return scene;
}

// The longest way along the cable, in pixels, beside which no pixel within 1.5 is red by a fifth.
// Two pixels at the ends are left out: what is beyond a texel's centre there may be cut off.
inline double widest_gap_px(const Rgba8Image& frame, const Camera& camera, const Cable& cable) {
  const glm::dvec2 from(raster_from_world(camera, cable.end(-1))),
      to(raster_from_world(camera, cable.end(1)));
  const double length = glm::length(to - from);
  const glm::dvec2 along = (to - from) / length, across(-along.y, along.x);
  constexpr double kStep = 0.125;
  double widest = 0, gap = 0;
  for (double at = 2; at < length - 2; at += kStep) {
    const glm::dvec2 place = from + at * along;
    if (place.x < 3 || place.y < 3 || place.x > kWidth - 3 || place.y > kHeight - 3) continue;
    bool red = false;
    for (double aside = -1.5; aside <= 1.5; aside += 0.25) {
      const glm::ivec2 pixel(glm::floor(place + aside * across));
      red |= frame(pixel.x, pixel.y).r > 51;
    }
    gap = red ? 0 : gap + kStep;
    widest = std::max(widest, gap);
  }
  return widest;
}

}  // namespace rilievo::test_cable

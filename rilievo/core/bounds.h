// Simple volumes that hold a thing: axis-aligned boxes and balls.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <limits>

namespace rilievo {

// An axis-aligned box, in the space that its owner names. By default it is empty.
struct Box {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  [[nodiscard]] bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  [[nodiscard]] glm::vec3 center() const { return 0.5f * (min + max); }
  [[nodiscard]] glm::vec3 extent() const { return max - min; }
  // Half the diagonal: the radius of the ball around the centre that holds the box.
  [[nodiscard]] float radius() const { return empty() ? 0.0f : 0.5f * glm::length(extent()); }

  void add(const glm::vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void add(const Box& b) {
    min = glm::min(min, b.min);
    max = glm::max(max, b.max);
  }

  [[nodiscard]] std::array<glm::vec3, 8> corners() const {
    std::array<glm::vec3, 8> c;
    for (int i = 0; i < 8; ++i)
      c[i] = {(i & 1) ? max.x : min.x, (i & 2) ? max.y : min.y, (i & 4) ? max.z : min.z};
    return c;
  }
};

// The axis-aligned box around `b` after an affine transform; an empty box stays empty.
[[nodiscard]] inline Box transformed(const glm::mat4& to_from, const Box& b) {
  if (b.empty()) return {};
  // Arvo's method: the extent transforms by the absolute values of the linear part.
  const glm::vec3 center = glm::vec3(to_from * glm::vec4(b.center(), 1.0f));
  const glm::vec3 half = 0.5f * b.extent();
  glm::vec3 reach{0.0f};
  for (int k = 0; k < 3; ++k) reach += glm::abs(glm::vec3(to_from[k])) * half[k];
  return {center - reach, center + reach};
}

// A ball; the owner names its space.
struct Ball {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

}  // namespace rilievo

// A lawn of hills as a layered impostor.
#pragma once

#include <cmath>
#include <utility>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo::test_shapes {

// 16 m wide and 1 m high; seen from above only if one-sided.
inline Scene lawn(bool double_sided) {
  Scene scene;
  const auto hills = [](double s, double t) {
    const double x = 16 * s - 8, z = 8 - 16 * t;
    return glm::vec3(x, 0.5 * std::sin(x) * std::cos(0.7 * z), z);
  };
  add(scene, grid_mesh(64, 64, hills), {0.2f, 0.6f, 0.2f});
  scene.materials[0].double_sided = double_sided;
  finish(scene);
  return scene;
}

inline LayeredImpostor impostor_of_scene(const Scene& scene, int size) {
  Result<LayeredImpostor> impostor =
      make_layered_impostor(cast_views(scene, make_view_set({}), {.size = size}), {});
  return std::move(*impostor);
}

// A direction to an eye that stands little above the horizon, or below it.
inline glm::dvec3 grazing_direction(std::mt19937& rng, bool above) {
  std::uniform_real_distribution<double> around(0, 2 * std::numbers::pi), up(0.1, 0.5);
  const double turn = around(rng), height = up(rng);
  return glm::normalize(glm::dvec3(std::cos(turn), above ? height : -height, std::sin(turn)));
}

}  // namespace rilievo::test_shapes

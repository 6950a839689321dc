// Impostors and eyes by chance, and how a bound compares with what was drawn.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo::test_shapes {

inline Scene scene_of(int which) {
  Scene scene;
  if (which == 0) return jug();
  if (which == 1) add(scene, torus(1.0, 0.3), {0.7f, 0.5f, 0.3f});
  if (which == 2) add(scene, box({1.0f, 0.6f, 0.3f}), {0.3f, 0.6f, 0.7f});
  if (which == 3) add(scene, sphere(1.0), {0.6f, 0.6f, 0.6f});
  finish(scene);
  return scene;
}

inline LayeredImpostor impostor_of(const Scene& scene, std::mt19937& rng, int size,
                                   ViewSpread spread = ViewSpread::faces_12) {
  const auto pick = [&](auto... values) {
    const float list[] = {float(values)...};
    return list[rng() % std::size(list)];
  };
  const SliceOptions slicing{
      .layers = int(pick(8, 24, 64)),
      .overlap = pick(0, 0.25, 1),
      .pieces = pick(0, 1, 1) != 0,
      .spacing = pick(0, 0, 1) ? SliceSpacing::window_z : SliceSpacing::eye_z};
  const Projection kind = pick(0, 1, 1) ? Projection::back_perspective : Projection::perspective;
  Result<LayeredImpostor> impostor = make_layered_impostor(
      cast_views(scene, make_view_set({.spread = spread}), {.projection = kind, .size = size}),
      slicing);
  return std::move(*impostor);
}

// Anywhere from just outside the box's ball to far away, turned off the object.
inline Camera random_camera(const Box& bounds, std::mt19937& rng, int size) {
  std::uniform_real_distribution<double> u(0, 1);
  std::normal_distribution<double> n;
  const double distance = 1.3 + 6 * u(rng) * u(rng), radius = bounds.radius();
  // One after the other, for the same order with every compiler.
  const auto vector = [&] {
    glm::dvec3 v;
    for (const int i : {2, 1, 0}) v[i] = n(rng);
    return v;
  };
  const glm::dvec3 direction = glm::normalize(vector());
  const glm::dvec3 center(bounds.center());
  const glm::dvec3 aside = 0.3 * radius * vector();
  return look_at(center + direction * (distance * radius), center + aside, {0.1, 1, 0.05},
                 2 * std::asin(std::min(0.9, 1 / distance)), size, size, 0.02 * radius,
                 20 * radius);
}

inline glm::dvec3 sample_of(const TexelSurface& surface, const glm::ivec2& texel) {
  return world_from_raster(surface.camera, glm::dvec2(texel) + 0.5,
                           1 / double(surface.texels(texel.x, texel.y).q));
}

inline double pixels_between(const Camera& camera, const glm::dvec3& a, const glm::dvec3& b) {
  return glm::distance(glm::dvec2(raster_from_world(camera, a)),
                       glm::dvec2(raster_from_world(camera, b)));
}

struct Tally {
  int cases = 0, points = 0, violations = 0;
  std::vector<double> tightness;  // bound over the largest error of a case, pixels

  void add(double bound_px, double worst_px, int points_of_case) {
    points += points_of_case;
    cases += points_of_case > 0;
    if (worst_px > 0 && std::isfinite(bound_px)) tightness.push_back(bound_px / worst_px);
  }
  double least() const { return *std::min_element(tightness.begin(), tightness.end()); }
  double median() {
    std::nth_element(tightness.begin(), tightness.begin() + tightness.size() / 2, tightness.end());
    return tightness[tightness.size() / 2];
  }
};

}  // namespace rilievo::test_shapes

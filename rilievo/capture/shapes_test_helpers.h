// Small scenes for tests, whose surfaces are known by formula, and what is seen of them.
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>
#include <utility>

#include "rilievo/capture/view_set.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/scene.h"

namespace rilievo::test_shapes {

// A surface over [0, 1]^2, counter-clockwise seen from outside if s x t points there.
template <class Surface>
Mesh grid_mesh(int columns, int rows, Surface surface) {
  Mesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      mesh.positions.push_back(surface(double(i) / columns, double(j) / rows));
  const auto id = [&](int i, int j) { return std::uint32_t(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      for (const auto& [di, dj] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}})
        mesh.indices.push_back(id(i + di, j + dj));
  return mesh;
}

inline Mesh sphere(double radius) {
  return grid_mesh(96, 48, [=](double s, double t) {
    const double a = 2 * std::numbers::pi * s, e = std::numbers::pi * (t - 0.5);
    return glm::vec3(radius *
                     glm::dvec3(std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)));
  });
}

inline Mesh torus(double radius, double tube, int columns = 96, int rows = 32) {
  return grid_mesh(columns, rows, [=](double s, double t) {
    const double a = 2 * std::numbers::pi * s, b = 2 * std::numbers::pi * t;
    const double r = radius + tube * std::cos(b);
    return glm::vec3(r * std::sin(a), tube * std::sin(b), r * std::cos(a));
  });
}

inline Mesh box(const glm::vec3& half) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  return mesh;
}

inline void add(Scene& scene, Mesh mesh, const glm::vec3& color,
                const glm::mat4& place = glm::mat4(1)) {
  Material material;
  material.base_color = glm::vec4(color, 1);
  mesh.material = int(scene.materials.size());
  scene.materials.push_back(material);
  scene.models.push_back({"", {{int(scene.meshes.size()), glm::mat4(1)}}, {}, 0});
  scene.meshes.push_back(std::move(mesh));
  Object object;
  object.model = int(scene.models.size()) - 1;
  object.placement = place;
  scene.objects.push_back(object);
}

// A jug: a round body, a handle that stands off it, a lid's knob. Concave, with true holes.
inline Scene jug() {
  Scene scene;
  const glm::mat4 one(1);
  add(scene, sphere(1.0), {0.8f, 0.3f, 0.2f}, glm::scale(one, {1, 0.9f, 1}));
  add(scene, torus(0.5, 0.1), {0.2f, 0.6f, 0.3f},
      glm::rotate(glm::translate(one, {1.1f, 0.1f, 0}), 1.5708f, {1, 0, 0}));
  add(scene, sphere(0.2), {0.2f, 0.3f, 0.8f}, glm::translate(one, {0, 1, 0}));
  add(scene, box({0.7f, 0.1f, 0.7f}), {0.7f, 0.7f, 0.6f}, glm::translate(one, {0, -0.85f, 0}));
  finish(scene);
  return scene;
}

// Pictures of a scene all around.
inline std::vector<DepthImage> cast_views(const Scene& scene, const ViewSet& views,
                                          const ViewCameraOptions& options) {
  const Result<RayScene> rays = RayScene::create(scene);
  const Box bounds = world_bounds(scene);
  std::vector<DepthImage> pictures;
  for (const glm::dvec3& direction : views.directions)
    pictures.push_back(cast_picture(*rays, *view_camera(bounds, direction, options)));
  return pictures;
}

// Evenly over all directions.
inline glm::dvec3 random_direction(std::mt19937& rng) {
  std::normal_distribution<double> n;
  return glm::normalize(glm::dvec3(n(rng), n(rng), n(rng)));
}

}  // namespace rilievo::test_shapes

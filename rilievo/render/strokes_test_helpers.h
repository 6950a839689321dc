// Points and lines, and by their definition in doubles what a picture of them shows. For tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// One point or line an object, so that identifiers name them: points of a size in metres, points of
// a size in pixels, and lines, around the origin; turned, scaled and mirrored.
inline Scene random_strokes(std::uint64_t seed, int count) {
  Random random(seed);
  const auto around = [&](float size) {
    // One after the other: compilers differ in the order in which they evaluate arguments.
    const float z = random.between(-1, 1), y = random.between(-1, 1);
    return size * glm::vec3(random.between(-1, 1), y, z);
  };
  Scene scene;
  scene.name = "strokes";
  for (int kind = 0; kind < 3; ++kind) {
    Mesh mesh;
    mesh.primitive = kind == 2 ? Primitive::lines : Primitive::points;
    mesh.width = kind == 0 ? 0.6f : 0;
    mesh.width_px = kind == 1 ? 5.0f : 1.0f;
    mesh.positions = {{0.1f, 0, 0}, {2, 1, 1}};
    mesh.colors = {{1, 0.5f, 0.25f, 1}, {0, 0.5f, 1, 1}};
    mesh.indices = {0};
    if (kind == 2) mesh.indices = {0, 1};
    scene.meshes.push_back(mesh);
    scene.models.emplace_back().parts = {Part{kind}};
  }
  for (int i = 0; i < count; ++i) {
    Object object;
    object.model = i % 3;
    object.placement = glm::translate(glm::mat4(1), around(3));
    object.placement = glm::rotate(object.placement, 3.0f, glm::normalize(around(1)));
    object.placement = glm::scale(object.placement, {i % 2 ? -1.0f : 2.0f, 1.0f, 1.0f});
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

// What a place of a picture shows.
struct StrokeSeen {
  std::uint32_t object = kNoObject;
  double eye_z = kNoDepth;
  bool doubtful = false;  // so near an edge, or another depth, that rounding decides
};

// Raster positions count from the top. `slack_px`: how far an edge may be off.
inline StrokeSeen stroke_at_raster(const Scene& scene, const Camera& camera,
                                   const glm::dvec2& raster, double slack_px) {
  StrokeSeen seen;
  std::vector<double> all;
  const bool parallel = camera.projection == Projection::parallel;
  const glm::dvec3 eye = camera.position(), axis = camera.forward();
  const glm::dvec3 origin = world_from_raster(camera, raster, camera.z_near);
  const glm::dvec3 way = world_from_raster(camera, raster, camera.z_near + 1) - origin;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const Mesh& mesh = scene.meshes[std::size_t(scene.objects[i].model)];
    const glm::dmat4 place(scene.objects[i].placement);
    const auto world = [&](std::size_t k) {
      return glm::dvec3(place * glm::dvec4(mesh.positions[k], 1));
    };
    double eye_z = 0, off_px = 0;  // beyond the edge
    if (mesh.primitive == Primitive::points) {
      const glm::dvec3 c = world(0) - eye;
      const double z = glm::dot(c, axis);
      if (z <= camera.z_near) continue;
      const glm::dvec3 at = raster_from_world(camera, world(0));
      if (mesh.width > 0) {
        // The disc through the centre, at right angles to the way from the eye.
        const glm::dvec3 normal = parallel ? axis : glm::normalize(c);
        const double t = glm::dot(world(0) - origin, normal) / glm::dot(way, normal);
        const glm::dvec3 hit = origin + t * way;
        eye_z = glm::dot(hit - eye, axis);
        // The texture of a disc's edge is as wide as its distance to the centre's place says.
        const double radius = 0.5 * double(mesh.width) * smallest_stretch(glm::mat4(place));
        const double distance = glm::length(hit - world(0));
        const double px = glm::length(glm::dvec2(at) - raster) / std::max(distance, 1e-9);
        off_px = (distance - radius) * px;
      } else {
        eye_z = z;
        off_px = glm::length(glm::dvec2(at) - raster) - 0.5 * double(mesh.width_px);
      }
    } else {
      glm::dvec3 p[2] = {world(0), world(1)};
      const double z[2] = {glm::dot(p[0] - eye, axis), glm::dot(p[1] - eye, axis)};
      if (std::max(z[0], z[1]) <= camera.z_near) continue;
      const glm::dvec3 along = p[1] - p[0], first = p[0];
      for (int k = 0; k < 2; ++k)
        if (z[k] < camera.z_near) p[k] = first + (camera.z_near - z[0]) / (z[1] - z[0]) * along;
      const glm::dvec3 a = raster_from_world(camera, p[0]), b = raster_from_world(camera, p[1]);
      const glm::dvec2 d = glm::dvec2(b) - glm::dvec2(a);
      const double s = std::clamp(glm::dot(raster - glm::dvec2(a), d) / glm::dot(d, d), 0.0, 1.0);
      off_px = glm::length(raster - glm::dvec2(a) - s * d) - 0.5 * double(mesh.width_px);
      eye_z = parallel ? a.z + s * (b.z - a.z) : 1 / ((1 - s) / a.z + s / b.z);
    }
    if (eye_z < camera.z_near || eye_z > camera.z_far) continue;
    if (std::abs(off_px) < slack_px) seen.doubtful = true;
    if (off_px > 0) continue;
    all.push_back(eye_z);
    const bool nearer = camera.keeps_farthest() ? !(eye_z <= seen.eye_z) || seen.object == kNoObject
                                                : eye_z < seen.eye_z;
    if (nearer) seen.eye_z = eye_z, seen.object = i + 1;
  }
  for (const double z : all)
    if (z != seen.eye_z && std::abs(z - seen.eye_z) < 1e-3) seen.doubtful = true;
  return seen;
}

// Eyes around and within random_strokes().
inline Camera stroke_camera(Random& random, Projection projection, int width, int height) {
  const auto number = [&](float low, float high) { return double(random.between(low, high)); };
  const double distance = projection == Projection::perspective ? number(1, 9) : number(7, 12);
  glm::dvec3 way;
  do way = {number(-1, 1), number(-1, 1), number(-1, 1)};
  while (glm::length(way) < 0.3);
  const double fov = number(0.5f, 1.6f);
  const glm::dvec3 target{number(-1, 1), 0, number(-1, 1)};
  Camera camera =
      look_at(distance * glm::normalize(way), target, {0.1, 1, 0.2}, fov, width, height, 0.2, 40);
  camera.projection = projection;
  if (projection == Projection::parallel) camera.window = {-4, 5, -4, 3};
  return camera;
}

}  // namespace rilievo

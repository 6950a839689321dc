// A red plate before a green wall: nothing that is drawn of them has another colour, but where both
// are seen.
#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/depth_image.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/scene.h"

namespace rilievo::test_plate {

inline Mesh square(float half) {
  Mesh mesh;
  mesh.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

// Material 0 is red, 1 green. Both shine alike from everywhere.
inline void add_red_and_green(Scene& scene) {
  for (const glm::vec3& color : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}) {
    Material material;
    material.base_color = glm::vec4(color, 1);
    material.unlit = material.double_sided = true;
    scene.materials.push_back(material);
  }
}

// The wall of 8 m lies on z = 0 and faces +z; the plate of 1.2 m is a metre before it, turned. Both
// shine alike from everywhere. They are one object or two.
inline Scene plate(Random& random, bool one_object) {
  Scene scene;
  add_red_and_green(scene);
  scene.meshes = {square(0.6f), square(4.0f)};
  scene.meshes[1].material = 1;
  scene.meshes[0].material = 0;
  // One after the other: compilers differ in the order in which they evaluate arguments.
  const float tilt = random.between(-0.4f, 0.4f), turn = random.between(0, 1.5f);
  const glm::mat4 turned = glm::rotate(
      glm::rotate(glm::translate(glm::mat4(1), {0, 0, 1}), turn, {0, 0, 1}), tilt, {0, 1, 0});
  if (one_object) {
    scene.models = {{"both", {{0, turned}, {1, glm::mat4(1)}}, {}, 0}};
    scene.objects.resize(1);
  } else {
    scene.models = {{"plate", {{0, turned}}, {}, 0}, {"wall", {{1, glm::mat4(1)}}, {}, 0}};
    scene.objects.resize(2);
    scene.objects[1].model = 1;
  }
  finish(scene);
  return scene;
}

// Sees the whole plate before the wall.
inline Camera plate_camera(Random& random, int size) {
  const float z = random.between(2.5f, 3.5f), y = random.between(-0.8f, 0.8f);
  const glm::dvec3 eye(random.between(-0.8f, 0.8f), y, z);
  return look_at(eye, {0, 0, 0.5}, {0, 1, 0}, 1.2, size, size, 0.1, 20);
}

// By how much is a colour, premultiplied, off red or green?
inline float off_color(const glm::vec4& color, bool red) {
  const glm::vec3 own = glm::vec3(color) / color.a;
  const glm::vec3 d = glm::abs(own - (red ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
  return std::max({d.x, d.y, d.z});
}

// By how much is a texel's colour off that of its surface? The plate's edge may be mixed, which is
// antialiasing; what is behind may not.
inline float off_surface(const DepthImage& picture, int x, int y) {
  const auto red = [&](int u, int v) {
    return picture.covered(u, v) &&
           world_from_raster(picture.camera, {u + 0.5, v + 0.5}, picture.depth(u, v)).z > 0.4;
  };
  bool edge = false;
  if (red(x, y))
    for (int k = 0; k < 9; ++k) {
      const int u = x + k % 3 - 1, v = y + k / 3 - 1;
      if (u >= 0 && v >= 0 && u < picture.depth.width() && v < picture.depth.height())
        edge |= !red(u, v);
    }
  if (!edge) return off_color(picture.color(x, y), red(x, y));
  const glm::vec4 color = picture.color(x, y);
  return std::max(std::abs(color.r + color.g - color.a), color.b);
}

// Is a place the plate's?
inline bool is_plate(const Camera& camera, const glm::dvec2& raster, double eye_z) {
  return world_from_raster(camera, raster, eye_z).z > 0.4;
}

}  // namespace rilievo::test_plate

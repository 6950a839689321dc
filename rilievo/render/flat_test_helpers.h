// A cube that is scaled, also to a sheet, a line or a point; for ever, or for a moment.
#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/scene/mesh_tools.h"
#include "rilievo/scene/scene.h"

namespace rilievo::test {

// Of a metre, with flat normals, a colour and a mask of nothing.
inline Scene scaled_cube(const glm::dvec3& scale) {
  Scene scene;
  Material red;
  red.base_color = {0.9f, 0.3f, 0.2f, 1.0f};
  scene.materials = {red};
  Mesh mesh;
  mesh.material = 0;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(0.5f * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  make_flat(mesh);
  scene.meshes = {mesh};
  scene.models.resize(1);
  scene.models[0].parts = {Part{}};
  Object object;
  object.placement = glm::mat4(glm::scale(glm::dmat4(1), scale));
  scene.objects = {object};
  finish(scene);
  return scene;
}

// The cube's scale goes from 1 to `scale` and back, in two seconds.
inline Scene squashed_cube(const glm::vec3& scale) {
  Scene scene = scaled_cube(glm::dvec3(1));
  scene.nodes.resize(1);
  scene.objects[0].node = 0;
  Channel channel;
  channel.path = Channel::Path::scale;
  channel.times = {0, 1, 2};
  channel.values = {glm::vec4(1), glm::vec4(scale, 0), glm::vec4(1)};
  scene.channels = {channel};
  scene.duration = 2;
  finish(scene);
  return scene;
}

// Sees the cube's front, side and top.
inline Camera cube_camera() {
  return look_at({1.1, 0.9, 2.1}, {0, 0, 0}, {0, 1, 0}, 0.6, 61, 53, 0.1, 10);
}

// Of all eight ways to make some axes 0: sheets that show, and what has no area.
inline std::vector<glm::dvec3> flat_scales() {
  return {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
}

// The same, but so thick that everything has an inverse.
inline glm::dvec3 thickened(const glm::dvec3& scale) { return glm::max(scale, glm::dvec3(1e-5)); }

inline bool is_sheet(const glm::dvec3& scale) { return scale.x + scale.y + scale.z == 2; }

}  // namespace rilievo::test

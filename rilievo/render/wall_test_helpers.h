// The least scene: one square.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// A square of `size` metres a side around the origin that faces +z. Not finished: tests change it
// before they call finish().
inline Scene wall_scene(float size, const Material& material) {
  const float half = 0.5f * size;
  Mesh wall;
  wall.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  wall.normals.assign(4, {0, 0, 1});
  wall.indices = {0, 1, 2, 0, 2, 3};
  wall.material = 0;
  Scene scene;
  scene.name = "wall";
  scene.meshes = {wall};
  scene.materials = {material};
  scene.models.resize(1);
  scene.models[0].parts = {Part{}};
  scene.objects.resize(1);
  return scene;
}

}  // namespace rilievo

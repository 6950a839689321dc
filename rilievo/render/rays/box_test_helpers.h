// A box as a mesh, for tests of rays.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// Of twelve triangles that look outwards, its vertices shared: smooth corners.
inline Mesh box_between(const glm::vec3& lo, const glm::vec3& hi) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z);
  mesh.indices = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                  2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
  return mesh;
}

}  // namespace rilievo

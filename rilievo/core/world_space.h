// World space of a file's content, and scene space, in which it is kept and drawn.
//
// Scenes keep single-precision coordinates, whose steps are half a metre where a map's coordinates
// count millions of metres. So a scene has an origin in double precision: readers subtract it
// before they round, and whatever leaves (files, texts for users, other programs) adds it again.
//
//     world = origin + scene           metres, right-handed, +y up
//
// Near the world's origin both are the same space: the origin is then 0.
#pragma once

#include <glm/glm.hpp>

namespace rilievo {

// The axis of a file's coordinates that points up.
enum class UpAxis { x, y, z };

// How the coordinates of a file became those of a world, and where the scene lies there.
struct WorldSpace {
  glm::dvec3 origin{0.0};  // world space
  // The file's own, before it was turned and scaled:
  UpAxis up = UpAxis::y;
  double metres_per_unit = 1;
  friend bool operator==(const WorldSpace&, const WorldSpace&) = default;
};

}  // namespace rilievo

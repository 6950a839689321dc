// How are meshes repaired after reading? Internal to loading.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// The vector with length 1; (0, 1, 0) for one that has no length.
[[nodiscard]] glm::vec3 unit_or_up(const glm::dvec3& v);

// The vector with length 1; 0 for one that has no length, which repair_normals() replaces.
[[nodiscard]] glm::vec3 unit_or_none(const glm::dvec3& v);

// Gives each triangle its own three vertices with the triangle's normal (counter-clockwise is
// front) and drops tangents. A triangle without area gets an arbitrary unit normal.
void make_flat(Mesh& mesh);

// Replaces normals that are not finite or have no length by the mean normal of their triangles, and
// normalises all. Requires one normal for each position, and indices in range.
void repair_normals(Mesh& mesh);

// Replaces texture coordinates, colours and tangents that are not finite. Returns the number of
// vertices changed.
std::size_t repair_attributes(Mesh& mesh);

// Swaps front and back of all triangles.
void flip_winding(Mesh& mesh);

}  // namespace rilievo

// Putting meshes in order after reading: what the readers of all formats need. Internal.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// Gives every triangle its own three vertices with the triangle's normal, counter-clockwise front;
// tangents are dropped. A triangle without area gets some unit normal.
void make_flat(Mesh& mesh);

// Replaces normals that are not finite or have no length by the mean of their triangles' normals,
// and makes all of unit length. Requires as many normals as positions and indices in range.
void repair_normals(Mesh& mesh);

// Replaces texture coordinates, colours and tangents that are not finite; how many vertices had
// any?
std::size_t repair_attributes(Mesh& mesh);

// The other side becomes the front.
void flip_winding(Mesh& mesh);

}  // namespace rilievo

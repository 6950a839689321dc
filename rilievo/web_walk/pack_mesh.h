// A node's mesh in few bytes, for browsers: integers, compressed by meshoptimizer.
//
// A vertex lies on the half-texel lattice, where a direction is an integer vector (cube_grid.h): it
// is exact in 16 bits. Its disparity is a code of 16 bits at most times a step; code 0 is the sky,
// which stays infinitely far. Vertices on one line of sight keep it, equal vertices stay equal: no
// crack opens. Little endian:
//
//   surface vertex  8 bytes: int16 direction x N [3], uint16 disparity
//   skin vertex    16 bytes: the same; int16 texture direction x 4 N [3], uint16 stretch
//
// N is the face's size. A stretch is stored as 8 times itself plus 1, and kAlways as 0. The quality
// of triangles is not stored: what texels count is a file of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/web_walk/walk.h"

namespace rilievo {

// The file of a mesh, and what its parts are; `mesh.file` is not set.
struct PackedMesh {
  std::vector<std::uint8_t> bytes;
  WalkMesh mesh;
};

// The step that moves a texel by at most `rounding_px`, in pixels of a frame as fine as the faces,
// for an eye `reach` metres from the node; larger where 16 bits do not suffice.
[[nodiscard]] double disparity_step(const NodeMesh& mesh, double rounding_px, double reach);

// Packs a mesh. Requires step > 0.
[[nodiscard]] PackedMesh pack_mesh(const NodeMesh& mesh, double step);

}  // namespace rilievo

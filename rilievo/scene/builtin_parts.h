// What the built-in scenes are put together from.
//
// Every mesh has vertex colours and smooth normals, stands on y = 0 around the y axis unless said
// otherwise, and is within a few percent of the triangles asked for.
#pragma once

#include <cstdint>
#include <functional>

#include "rilievo/scene/builtin.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

enum class TreeKind { oak, poplar, fir, birch, bush };
inline constexpr int kTreeKinds = 5;
// Metres: oak 11, poplar 15, fir 14, birch 12, bush 3.
[[nodiscard]] Mesh make_tree(TreeKind kind, std::uint64_t seed, int triangles);

// A square of ground with the corner of least x and z at `corner` (x, z), 2 cells^2 triangles,
// around its own centre: to be placed at (corner.x + size / 2, 0, corner.y + size / 2). Normals are
// those of the height field, so that neighbouring squares meet without a seam.
struct Ground {
  std::function<float(float x, float z)> height;
  std::function<glm::vec3(const glm::vec3& point)> color;
};
[[nodiscard]] Mesh make_ground(const Ground& ground, const glm::vec2& corner, float size,
                               int cells);

// Newell's teapot, 3.15 high in a box of 6.43 x 4; the handle towards -x.
[[nodiscard]] Mesh make_teapot(int triangles);

[[nodiscard]] BuiltinScene make_forest(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_teapots(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_single_teapot(std::uint64_t triangles);

}  // namespace rilievo

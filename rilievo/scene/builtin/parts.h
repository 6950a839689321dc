// What the built-in scenes are put together from.
//
// Every mesh has vertex colours and smooth normals, stands on y = 0 around the y axis unless said
// otherwise, and is within a few percent of the triangles asked for.
#pragma once

#include <cstdint>
#include <functional>

#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// 50 degrees, 79 degrees wide at 16:9.
inline constexpr float kBuiltinFov = 0.87f;

enum class TreeKind { oak, poplar, fir, birch, bush };
inline constexpr int kTreeKinds = 5;
// Metres: oak 11, poplar 15, fir 14, birch 12, bush 3.
[[nodiscard]] Mesh make_tree(TreeKind kind, std::uint64_t seed, int triangles);

enum class VehicleKind { car, truck, bus };
// Forward is +x. Metres without mirrors: car 4.2 x 1.75, truck 7.4 x 2.8, bus 9.6 x 2.5.
[[nodiscard]] Mesh make_vehicle(VehicleKind kind, const glm::vec3& paint, int triangles);

// A house of stone, 9 x 6.5, 8 high, its ridge along x; a round tower, 16 high, 5 across; a lamp
// post, 4 high; a rock, about 1 across, its centre at the origin.
[[nodiscard]] Mesh make_house(std::uint64_t seed, int triangles);
[[nodiscard]] Mesh make_tower(std::uint64_t seed, int triangles);
[[nodiscard]] Mesh make_lamp_post(int triangles);
[[nodiscard]] Mesh make_rock(std::uint64_t seed, int triangles);

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

[[nodiscard]] BuiltinScene make_bridge(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_forest(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_teapots(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_stonehenge(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_single_teapot(std::uint64_t triangles);
[[nodiscard]] BuiltinScene make_fern(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_fish(std::uint64_t triangles, std::uint64_t seed);
[[nodiscard]] BuiltinScene make_cube(std::uint64_t triangles, std::uint64_t seed);

}  // namespace rilievo

// Polygons whose corners refer to positions, texture coordinates and normals separately, as OBJ,
// PLY and STL have them; and how they become meshes. Internal to loading; throws LoadFault.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

struct Corner {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t position = kNone, uv = kNone, normal = kNone;
  friend bool operator==(const Corner&, const Corner&) = default;
};

struct PolygonSoup {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec4> colors;  // empty, or one a position; linear
  std::vector<glm::vec2> uv;
  std::vector<glm::vec3> normals;

  // Three corners a triangle, and which part of the file each triangle belongs to.
  std::vector<Corner> triangles;
  std::vector<std::uint32_t> parts;
};

// Appends `polygon`, cut into triangles, to part `part`. Any simple polygon, convex or not, that is
// nearly flat; one that is not simple comes out somehow. Corners must refer to what exists.
void add_polygon(PolygonSoup& soup, std::span<const Corner> polygon, std::uint32_t part,
                 MemoryBudget& budget);

// Gives a normal to every corner that has none: the mean of the triangles around its position whose
// planes are within 45 degrees of its own.
void add_missing_normals(PolygonSoup& soup, MemoryBudget& budget);

// The triangles of every part as a mesh (part i is mesh i); corners that agree share a vertex.
// Requires that every corner has a normal.
[[nodiscard]] std::vector<Mesh> weld(const PolygonSoup& soup, std::size_t parts,
                                     MemoryBudget& budget);

}  // namespace rilievo

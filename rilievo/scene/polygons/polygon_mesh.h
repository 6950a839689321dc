// How do polygons become meshes whose corners refer to positions, texture coordinates and normals
// separately? OBJ, PLY and STL store them so. Internal to loading; throws LoadError.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// A polygon's corner: indices into PolygonSoup; kNone where the file gives none.
struct Corner {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t position = kNone, uv = kNone, normal = kNone;
  std::uint32_t color = kNone;  // kNone: that of the position
  friend bool operator==(const Corner&, const Corner&) = default;
};

// Points, or the ends of lines, of a whole file.
struct Strokes {
  std::vector<Corner> corners;       // one each, or two
  std::vector<std::uint32_t> parts;  // of each primitive
};

// Triangles, lines and points of a whole file, with their attributes.
struct PolygonSoup {
  std::vector<glm::dvec3> positions;  // world space; finite floats where a corner refers to them
  glm::dvec3 origin{0.0};             // of the meshes' space
  std::vector<glm::vec4> colors;      // linear; empty, or one for each position, then any others
  std::vector<glm::vec2> uv;
  std::vector<glm::vec3> normals;

  // Three corners for each triangle, and the index of the part that each triangle belongs to:
  std::vector<Corner> triangles;
  std::vector<std::uint32_t> parts;
  // How corners without normals get theirs (add_missing_normals): empty, or for each triangle
  // kFlat, kCreased, or a smoothing group of its own number.
  static constexpr std::uint32_t kFlat = 0, kCreased = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> smoothing;

  Strokes lines, points;
  // All vertices are points of part 0, and there is nothing else.
  bool all_points = false;

  // The corners that add_polygon may still look at to cut polygons that are not convex. It looks at
  // 200 million in about a second, and a simple polygon of 20 000 corners needs less than half of
  // them. Each polygon adds 256 for each of its corners.
  std::int64_t work_left = 200'000'000;
  bool cut_short = false;  // work_left did not suffice: the rest of a polygon became a fan

  // A position as meshes have it.
  [[nodiscard]] glm::vec3 place(std::uint32_t position) const {
    return glm::vec3(positions[position] - origin);
  }
};

// Triangulates `polygon` and appends it to part `part`. Handles nearly flat simple polygons, convex
// or not; any other polygon, and one that takes more than soup.work_left, gives an arbitrary
// triangulation. Corners must refer to existing entries.
void add_polygon(PolygonSoup& soup, std::span<const Corner> polygon, std::uint32_t part,
                 MemoryBudget& budget);

[[nodiscard]] bool is_finite(const glm::vec3& position);

// The first corner whose position is not finite, or none.
[[nodiscard]] const Corner* corner_that_is_not_finite(const PolygonSoup& soup,
                                                      std::span<const Corner> polygon);

// Gives a normal to each corner that has none: its triangle's own (kFlat), the mean normal of the
// triangles of its smoothing group around its position, or (kCreased) of those among the other
// creased ones whose planes lie within 45 degrees of its own. Positions that are not finite become
// 0: no corner refers to them.
void add_missing_normals(PolygonSoup& soup, MemoryBudget& budget);

// One mesh for each part, in order, of its lines or points; each corner is a vertex of its own. A
// part has normals if all its corners have. Empties the soup if all of it is points.
[[nodiscard]] std::vector<Mesh> stroke_meshes(PolygonSoup& soup, Primitive primitive,
                                              std::size_t parts, MemoryBudget& budget);

// One mesh for each part, in order; equal corners share a vertex. Requires that each corner has a
// normal.
[[nodiscard]] std::vector<Mesh> weld(const PolygonSoup& soup, std::size_t parts,
                                     MemoryBudget& budget);

}  // namespace rilievo

// The size at which a scene's points are drawn.
//
// Files of points say where they are, not how large. Without an option a mesh's points get the
// diameter that closes a surface of them: 1.6 times the median distance to the sixth nearest
// neighbour (a square grid's sixth is its diagonal), at most a hundredth of the cloud's size, so
// that few points stay points. Points are put into the order of a space-filling curve [Morton
// 1966], so that runs of them are near each other. Any thread.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "rilievo/scene/scene.h"

namespace rilievo {

// A diameter, in metres of the world or in pixels; both 0: from the density of each mesh.
struct PointSize {
  float metres = 0, pixels = 0;
};

// Reads "0.02", "2px" or "auto". Nothing if it is none of these, or not above 0.
[[nodiscard]] std::optional<PointSize> parse_point_size(std::string_view text);

// The diameter that closes a surface of the mesh's points, metres of mesh space. 0 if they are all
// in one place. Requires points in the order of sort_points().
[[nodiscard]] float point_diameter(const Mesh& mesh);

// Puts a mesh's points into the order of the curve, one vertex each.
void sort_points(Mesh& mesh);

// Gives all points their size, and what is points or lines opaque materials; for a scene that is
// neither finished nor validated. Sorts the points, but for those of the meshes of `bent`, indices:
// what bends a mesh knows its vertices by their numbers.
void finish_points(Scene& scene, const PointSize& size, std::span<const int> bent = {});

}  // namespace rilievo

#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "rilievo/scene/polygons/polygon_mesh.h"

namespace rilievo {
namespace {

// Leaves out those whose positions are not finite: scanners write NaN for what they did not
// measure.
void keep_finite(Mesh& mesh) {
  std::size_t kept = 0;
  const auto move = [&](auto& values, std::size_t from) {
    if (!values.empty()) values[kept] = values[from];
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!is_finite(mesh.positions[i])) continue;
    move(mesh.normals, i), move(mesh.uv[0], i), move(mesh.colors, i);
    mesh.positions[kept++] = mesh.positions[i];
  }
  const auto cut = [&](auto& values) {
    if (!values.empty()) values.resize(kept);
  };
  cut(mesh.positions), cut(mesh.normals), cut(mesh.uv[0]), cut(mesh.colors);
}

Mesh mesh_of_vertices(PolygonSoup& soup, MemoryBudget& budget) {
  Mesh mesh;
  mesh.primitive = Primitive::points;
  budget.take(soup.positions.size(), sizeof(std::uint32_t) + sizeof(glm::vec3));
  mesh.positions.reserve(soup.positions.size());
  for (std::uint32_t i = 0; i < soup.positions.size(); ++i) mesh.positions.push_back(soup.place(i));
  soup.positions = {};
  mesh.normals = std::move(soup.normals);
  mesh.uv[0] = std::move(soup.uv);
  mesh.colors = soup.colors;  // whether there are any is asked for later
  keep_finite(mesh);
  mesh.indices.resize(mesh.positions.size());
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  return mesh;
}

}  // namespace

std::vector<Mesh> stroke_meshes(PolygonSoup& soup, Primitive primitive, std::size_t parts,
                                MemoryBudget& budget) {
  std::vector<Mesh> meshes(parts);
  if (primitive == Primitive::points && soup.all_points) {
    meshes[0] = mesh_of_vertices(soup, budget);
    return meshes;
  }
  const Strokes& strokes = primitive == Primitive::points ? soup.points : soup.lines;
  const std::size_t corners = corners_of(primitive);
  std::vector<std::uint8_t> has_normals(parts, 1);
  for (std::size_t i = 0; i < strokes.corners.size(); ++i)
    if (strokes.corners[i].normal == Corner::kNone) has_normals[strokes.parts[i / corners]] = 0;
  const std::size_t each =
      2 * (2 * sizeof(glm::vec3) + (soup.uv.empty() ? 0 : sizeof(glm::vec2)) +
           (soup.colors.empty() ? 0 : sizeof(glm::vec4)) + sizeof(std::uint32_t));
  for (std::size_t i = 0; i < strokes.corners.size(); ++i) {
    const Corner& c = strokes.corners[i];
    const std::uint32_t part = strokes.parts[i / corners];
    if (!is_finite(glm::vec3(soup.positions[c.position])))
      refuse("has a point or a line with vertex " + std::to_string(c.position + 1) +
             ", whose position is not finite");
    Mesh& mesh = meshes[part];
    budget.take(each);
    mesh.primitive = primitive;
    mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
    mesh.positions.push_back(soup.place(c.position));
    if (has_normals[part]) mesh.normals.push_back(soup.normals[c.normal]);
    if (!soup.uv.empty())
      mesh.uv[0].push_back(c.uv == Corner::kNone ? glm::vec2(0) : soup.uv[c.uv]);
    if (!soup.colors.empty())
      mesh.colors.push_back(soup.colors[c.color == Corner::kNone ? c.position : c.color]);
  }
  return meshes;
}

}  // namespace rilievo

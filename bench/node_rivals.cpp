#include "bench/node_rivals.h"

#include <meshoptimizer.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo::bench {
namespace {

// At a raster position, between texels' centres.
float between_texels(const CubeGrid& grid, int f, double x, double y) {
  const int n = grid.size();
  const double u = std::clamp(x - 0.5, 0.0, n - 1.0), v = std::clamp(y - 0.5, 0.0, n - 1.0);
  const int i = std::min(int(u), n - 2), j = std::min(int(v), n - 2);
  const auto at = [&](int dx, int dy) { return std::max(0.0f, grid.at(f, {i + dx, j + dy})); };
  const float a = float(u - i), b = float(v - j);
  return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
}

glm::vec3 direction(int f, double x, double y, int n) {
  const FaceAxes& axes = face_axes()[std::size_t(f)];
  return glm::vec3(axes.forward) + float(2 * x / n - 1) * glm::vec3(axes.right) +
         float(1 - 2 * y / n) * glm::vec3(axes.up);
}

struct FaceTriangles {
  std::vector<glm::vec3> points;  // x, y, disparity
  std::vector<unsigned> indices;
};

NodeMesh joined(const EnvironmentMap& map, const std::array<FaceTriangles, 6>& faces, int n) {
  NodeMesh mesh;
  mesh.world_from_node = world_from_node(map);
  mesh.face_size = n;
  for (int f = 0; f < 6; ++f) {
    const FaceTriangles& face = faces[std::size_t(f)];
    const std::uint32_t base = std::uint32_t(mesh.vertices.size());
    const std::uint32_t first = std::uint32_t(mesh.triangles());
    for (const glm::vec3& p : face.points) {
      const glm::vec3 c = direction(f, p.x, p.y, n);
      mesh.vertices.push_back({c, p.z, c});
    }
    for (const unsigned i : face.indices) mesh.indices.push_back(base + i);
    mesh.surfaces[std::size_t(f)] = {first, std::uint32_t(mesh.triangles()) - first};
  }
  for (TriangleRange& range : mesh.skins) range = {std::uint32_t(mesh.triangles()), 0};
  mesh.quality.resize(mesh.triangles(), 1.0f);
  return mesh;
}

// m x m cells over a face, vertices at `at(i)` in both directions.
template <class At>
FaceTriangles cells(const CubeGrid& grid, int f, int m, At&& at) {
  FaceTriangles face;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= m; ++i)
      face.points.push_back({at(i), at(j), between_texels(grid, f, at(i), at(j))});
  const unsigned row = unsigned(m) + 1;
  for (unsigned j = 0; j < unsigned(m); ++j)
    for (unsigned i = 0; i < unsigned(m); ++i) {
      const unsigned a = j * row + i, b = a + 1, c = a + row, d = c + 1;
      face.indices.insert(face.indices.end(), {a, b, c, b, d, c});
    }
  return face;
}

}  // namespace

NodeMesh grid_mesh(const EnvironmentMap& map, std::size_t triangles) {
  const CubeGrid grid(map, {});
  const int m = std::max(1, int(std::sqrt(double(triangles) / 12)));
  std::array<FaceTriangles, 6> faces;
  for (int f = 0; f < 6; ++f)
    faces[std::size_t(f)] = cells(grid, f, m, [&](int i) { return double(i) * grid.size() / m; });
  return joined(map, faces, grid.size());
}

NodeMesh simplified_mesh(const EnvironmentMap& map, std::size_t triangles, float weight) {
  const CubeGrid grid(map, {});
  const int n = grid.size();
  std::array<FaceTriangles, 6> full, best;
  std::array<std::vector<glm::vec3>, 6> scaled;
  float largest = 0;
  for (int f = 0; f < 6; ++f)
    for (const float d : grid.disparity(f).texels()) largest = std::max(largest, d);
  for (int f = 0; f < 6; ++f) {
    // A vertex a texel; those of the outermost at the face's border.
    full[std::size_t(f)] = cells(grid, f, n - 1, [&](int i) {
      return i == 0 ? 0.0 : i == n - 1 ? double(n) : i + 0.5;
    });
    for (const glm::vec3& p : full[std::size_t(f)].points)
      scaled[std::size_t(f)].push_back({p.x / float(n), p.y / float(n), weight * p.z / largest});
  }
  double low = -18, high = -2;  // log2 of the error
  for (int step = 0; step < 8; ++step) {
    const double middle = 0.5 * (low + high);
    std::array<FaceTriangles, 6> made;
    tbb::parallel_for(0, 6, [&](int face) {
      const std::size_t f = std::size_t(face);
      const std::vector<unsigned>& all = full[f].indices;
      std::vector<unsigned>& kept = made[f].indices;
      kept.resize(all.size());
      kept.resize(meshopt_simplify(kept.data(), all.data(), all.size(), &scaled[f][0].x,
                                   scaled[f].size(), sizeof(glm::vec3), 6, float(std::exp2(middle)),
                                   0, nullptr));
      made[f].points = full[f].points;
    });
    std::size_t sum = 0;
    for (const FaceTriangles& face : made) sum += face.indices.size() / 3;
    if (sum <= triangles) {
      best = std::move(made);
      high = middle;
    } else {
      low = middle;
    }
  }
  return joined(map, best, n);
}

}  // namespace rilievo::bench

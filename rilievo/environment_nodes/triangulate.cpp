// Silhouettes first, then the points on shared cube edges, then greedy insertion face by face, in
// rounds of ever smaller errors that all faces go through together. A round that ends above the
// budget is taken back, and of its points those with the largest errors are added once more: what
// one queue for all faces would have chosen, whatever the number of threads.

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/assemble_mesh.h"
#include "rilievo/environment_nodes/cube_edges.h"
#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/environment_nodes/silhouettes.h"
#include "rilievo/environment_nodes/texel_weights.h"

namespace rilievo {
namespace {

using Faces = std::array<std::unique_ptr<FaceMesh>, 6>;
using Silhouettes = std::array<std::vector<Silhouette>, 6>;

constexpr float kRound = 0.6f;  // from one round's error to the next one's

// A quarter of the median distance of what the faces show, by every eighth texel.
double usual_reach(const EnvironmentMap& map) {
  std::vector<float> distances;
  for (const DepthImage& face : map.faces)
    for (int y = 4; y < face.depth.height(); y += 8)
      for (int x = 4; x < face.depth.width(); x += 8)
        if (face.covered(x, y))
          distances.push_back(float(depth_from_eye_z(
              DepthKind::ray,
              eye_z_from(face.depth_kind, face.depth(x, y), face.camera, {x + 0.5, y + 0.5}),
              face.camera, {x + 0.5, y + 0.5})));
  if (distances.empty()) return 1;
  std::nth_element(distances.begin(), distances.begin() + std::ptrdiff_t(distances.size() / 2),
                   distances.end());
  return 0.25 * distances[distances.size() / 2];
}

Silhouettes trace(const CubeGrid& grid) {
  Silhouettes all;
  parallel_for(0, 6, [&](int f) { all[std::size_t(f)] = trace_silhouettes(grid, f); });
  return all;
}

// Triangles that a line costs.
std::size_t cost(const Silhouette& s) { return 2 * (s.line.size() - 1); }

std::size_t total_cost(const Silhouettes& all) {
  std::size_t sum = 0;
  for (const auto& of_face : all)
    for (const Silhouette& s : of_face) sum += cost(s);
  return sum;
}

// Joins the surfaces along the lines that tell least for what they cost, until the others cost no
// more than `most`. How many?
std::size_t leave_out(CubeGrid& grid, const Silhouettes& all, std::size_t most) {
  struct Entry {
    double worth;
    int face;
    const Silhouette* line;
  };
  std::vector<Entry> order;
  std::size_t sum = 0;
  for (int f = 0; f < 6; ++f)
    for (const Silhouette& s : all[std::size_t(f)])
      if (s.to_nothing)
        sum += cost(s);
      else
        order.push_back({s.worth / double(cost(s)), f, &s});
  std::stable_sort(order.begin(), order.end(),
                   [](const Entry& a, const Entry& b) { return a.worth > b.worth; });
  std::size_t out = 0;
  for (const Entry& entry : order) {
    sum += cost(*entry.line);
    if (sum <= most) continue;
    ++out;
    const std::vector<glm::ivec2>& corners = entry.line->corners;
    for (std::size_t i = 1; i < corners.size(); ++i) {
      const glm::ivec2 low = glm::min(corners[i - 1], corners[i]);
      if (corners[i - 1].x == corners[i].x)
        grid.join_right(entry.face, low.x - 1, low.y);
      else
        grid.join_below(entry.face, low.x, low.y - 1);
    }
  }
  return out;
}

std::size_t count_triangles(const Faces& faces) {
  std::size_t sum = 0;
  for (const auto& face : faces) sum += face->count_triangles();
  return sum;
}

float worst_error(const Faces& faces) {
  float worst = 0;
  for (const auto& face : faces) worst = std::max(worst, face->worst_error());
  return worst;
}

// How many points of each face belong to the `most` with the largest errors? A point comes after
// those of its face that were added before it.
std::array<std::size_t, 6> largest(const std::array<std::vector<float>, 6>& errors,
                                   std::size_t most) {
  struct Entry {
    float error;
    int face;
  };
  std::vector<Entry> order;
  for (int f = 0; f < 6; ++f) {
    float least = INFINITY;
    for (const float error : errors[std::size_t(f)]) {
      least = std::min(least, error);
      order.push_back({least, f});
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Entry& a, const Entry& b) { return a.error > b.error; });
  std::array<std::size_t, 6> counts{};
  for (std::size_t i = 0; i < std::min(most, order.size()); ++i)
    ++counts[std::size_t(order[i].face)];
  return counts;
}

void refine(Faces& faces, CubeEdges& edges, float error, std::size_t budget) {
  std::array<FaceMesh*, 6> pointers;
  for (std::size_t f = 0; f < 6; ++f) pointers[f] = faces[f].get();
  for (float level = worst_error(faces); level > error;) {
    level = std::max(error, kRound * level);
    const std::size_t on_edges = 2 * edges.count(level);
    if (budget && count_triangles(faces) + on_edges + 2 > budget) return;
    edges.refine(level, pointers);
    const std::size_t most = budget ? (budget - count_triangles(faces)) / 2 : std::size_t(-1);
    Faces kept;
    std::array<std::vector<float>, 6> errors;
    parallel_for(std::size_t(0), std::size_t(6), [&](std::size_t f) {
      if (budget) kept[f] = std::make_unique<FaceMesh>(*faces[f]);
      faces[f]->refine(level, most, &errors[f]);
    });
    if (worst_error(faces) == 0) return;
    if (!budget || count_triangles(faces) <= budget) continue;
    const std::array<std::size_t, 6> counts = largest(errors, most);
    parallel_for(std::size_t(0), std::size_t(6), [&](std::size_t f) {
      faces[f] = std::move(kept[f]);
      faces[f]->refine(0, counts[f]);
    });
    return;
  }
}

}  // namespace

NodeMesh triangulate(const EnvironmentMap& map, const TriangulateOptions& options,
                     TriangulateStats* stats) {
  RILIEVO_EXPECTS(validate_environment(map).ok());
  const double reach = options.reach > 0 ? options.reach : usual_reach(map);
  const double px_per_disparity = reach * 0.5 * map.faces[0].camera.width;
  const float error = float(std::max(0.0, options.error_px) / px_per_disparity);
  CutOptions cuts;
  cuts.least_step = error;
  CubeGrid grid(map, cuts);
  Silhouettes silhouettes = trace(grid);
  TriangulateStats done;
  if (options.triangles) {
    const std::size_t most = std::size_t(options.silhouette_share * double(options.triangles));
    // What is left is joined to longer lines, which may cost a little more or less.
    if (total_cost(silhouettes) > most) {
      done.left_out = leave_out(grid, silhouettes, most);
      silhouettes = trace(grid);
    }
  }
  for (const auto& of_face : silhouettes) done.silhouettes += of_face.size();
  done.silhouette_triangles = total_cost(silhouettes);

  CubeEdges edges(grid);
  Faces faces;
  parallel_for(0, 6, [&](int f) {
    faces[std::size_t(f)] =
        std::make_unique<FaceMesh>(grid, f, silhouettes[std::size_t(f)], edges.required(f));
  });
  refine(faces, edges, error, options.triangles);
  if (stats) {
    done.reach = reach;
    done.worst_error = worst_error(faces);
    done.worst_error_px = done.worst_error * px_per_disparity;
    *stats = done;
  }
  std::array<const FaceMesh*, 6> pointers;
  for (std::size_t f = 0; f < 6; ++f) pointers[f] = faces[f].get();
  NodeMesh mesh = assemble_mesh(grid, pointers);
  mesh.world_from_node = world_from_node(map);
  mesh.weights = texel_weights(grid);
  return mesh;
}

}  // namespace rilievo

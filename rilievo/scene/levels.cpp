#include "rilievo/scene/levels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/scene/mesh_distance.h"
#include "rilievo/scene/shading_error.h"

namespace rilievo {
namespace {

struct MeshLevel {
  std::vector<std::uint32_t> indices;
  double error = 0;  // mesh space
};

// Of what is asked for, a level has at most this share more.
constexpr double kReached = 1.2;

// The vertices that a level uses, in the order in which it does: each of meshoptimizer's passes
// looks at all that it is given, and a coarse level uses few of the mesh's.
struct UsedVertices {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> vertices;  // the mesh's
  std::vector<std::uint32_t> indices;   // of `positions`

  UsedVertices(const std::vector<glm::vec3>& all, const std::vector<std::uint32_t>& of) {
    constexpr std::uint32_t kUnused = 0xFFFFFFFFu;
    std::vector<std::uint32_t> place(all.size(), kUnused);
    indices.reserve(of.size());
    for (const std::uint32_t vertex : of) {
      if (place[vertex] == kUnused) {
        place[vertex] = std::uint32_t(vertices.size());
        vertices.push_back(vertex);
        positions.push_back(all[vertex]);
      }
      indices.push_back(place[vertex]);
    }
  }
};

MeshLevel simplify_mesh(const Mesh& mesh, const std::vector<std::uint32_t>& of,
                        std::size_t target) {
  const UsedVertices used(mesh.positions, of);
  const std::vector<std::uint32_t>& indices = used.indices;
  const float* positions = &used.positions[0].x;
  const std::size_t count = used.positions.size(), stride = sizeof(glm::vec3);
  const double scale = double(meshopt_simplifyScale(positions, count, stride));
  MeshLevel level;
  level.indices.resize(indices.size());
  float error = 0;
  const auto run = [&](bool sloppy) {
    const std::size_t made =
        sloppy ? meshopt_simplifySloppy(level.indices.data(), indices.data(), indices.size(),
                                        positions, count, stride, target, 1.0f, &error)
               : meshopt_simplify(level.indices.data(), indices.data(), indices.size(), positions,
                                  count, stride, target, 1.0f, 0, &error);
    level.error = scale * double(error);
    return made;
  };
  std::size_t made = run(false);
  if (double(made) > kReached * double(target)) {
    level.indices.resize(indices.size());
    made = run(true);
  }
  level.indices.resize(made);
  for (std::uint32_t& index : level.indices) index = used.vertices[index];
  return level;
}

std::vector<MeshLevel> mesh_levels(const Mesh& mesh, const LevelsOptions& options) {
  std::vector<MeshLevel> levels;
  if (mesh.primitive != Primitive::triangles) return levels;
  const std::vector<std::uint32_t>* finer = &mesh.indices;
  double error = 0;
  // The mesh's own normals may look aside, too.
  const double own = shading_error(mesh, mesh.indices);
  while (int(levels.size()) < options.max_levels &&
         finer->size() / 3 >= std::max<std::uint64_t>(2 * options.min_triangles, 2)) {
    std::size_t target = finer->size() / 6 * 3;
    if (options.most_triangles > 0)
      target = std::min(target, std::size_t(3 * options.most_triangles));
    MeshLevel level = simplify_mesh(mesh, *finer, target);
    if (level.indices.empty() || level.indices.size() > finer->size() * 9 / 10) break;
    // Each level is made from the one before: their errors add up.
    error += level.error;
    const double shading = std::max(shading_error(mesh, level.indices) - own, 0.0);
    level.error = std::max({error, shading, levels.empty() ? 0 : levels.back().error});
    meshopt_optimizeVertexCache(level.indices.data(), level.indices.data(), level.indices.size(),
                                mesh.positions.size());
    levels.push_back(std::move(level));
    finer = &levels.back().indices;
  }
  return levels;
}

// The level's mesh with the vertices that it uses.
Mesh compact_mesh(const Mesh& mesh, std::vector<std::uint32_t> indices) {
  constexpr std::uint32_t kUnused = 0xFFFFFFFFu;
  std::vector<std::uint32_t> place(mesh.positions.size(), kUnused), kept;
  for (std::uint32_t& index : indices) {
    if (place[index] == kUnused) {
      place[index] = std::uint32_t(kept.size());
      kept.push_back(index);
    }
    index = place[index];
  }
  const auto pick = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    for (const std::uint32_t vertex : kept) to.push_back(from[vertex]);
  };
  Mesh level;
  level.name = mesh.name, level.material = mesh.material;
  pick(mesh.positions, level.positions);
  pick(mesh.normals, level.normals);
  pick(mesh.tangents, level.tangents);
  for (int set = 0; set < 2; ++set) pick(mesh.uv[set], level.uv[set]);
  pick(mesh.colors, level.colors);
  level.indices = std::move(indices);
  return level;
}

// Bounded levels: what is farther away than this share of the mesh's radius is of no use, nor are
// bounds that are more exact than this share of it, or of what meshoptimizer states.
constexpr double kUseful = 0.1, kFinest = 1e-5, kExact = 0.05;
// A level is kept if it has at most this share of the finer one's triangles.
constexpr double kFewer = 0.7;
// Larger meshes have no bounded levels: seconds, for a level that is seldom fine enough.
constexpr std::size_t kMaxBounded = 400'000;

bool may_be_bounded(const Scene& scene, const Mesh& mesh) {
  return mesh.indices.size() / 3 <= kMaxBounded &&
         (mesh.material < 0 ||
          scene.materials[std::size_t(mesh.material)].alpha_mode == AlphaMode::opaque);
}

// Replaces the errors of all meshes' levels by bounds, and drops the levels that have none.
void bound_levels(const Scene& scene, std::vector<std::vector<MeshLevel>>& of_mesh) {
  struct Job {
    std::size_t mesh, level;
    bool from_level;
    double upper = 0;
  };
  std::vector<Job> jobs;
  std::vector<std::size_t> leveled;
  for (std::size_t i = 0; i < of_mesh.size(); ++i) {
    if (!of_mesh[i].empty()) leveled.push_back(i);
    for (std::size_t level = 0; level < of_mesh[i].size(); ++level)
      for (const bool from_level : {false, true}) jobs.push_back({i, level, from_level});
  }
  std::vector<std::unique_ptr<TriangleTree>> trees(of_mesh.size());
  parallel_for(std::size_t(0), leveled.size(), [&](std::size_t k) {
    const Mesh& mesh = scene.meshes[leveled[k]];
    trees[leveled[k]] = std::make_unique<TriangleTree>(mesh.positions, mesh.indices);
  });
  parallel_for(std::size_t(0), jobs.size(), [&](std::size_t k) {
    Job& job = jobs[k];
    const Mesh& mesh = scene.meshes[job.mesh];
    const MeshLevel& level = of_mesh[job.mesh][job.level];
    const double radius = double(mesh.bounds.radius());
    DistanceOptions options;
    options.share = kExact;
    options.slack = std::max(kFinest * radius, kExact * level.error);
    options.too_far = kUseful * radius;
    if (job.from_level)
      job.upper = farthest_from(*trees[job.mesh], mesh.positions, level.indices,
                                mesh.indices.size() / 3, options)
                      .upper;
    else
      job.upper = farthest_from(TriangleTree(mesh.positions, level.indices), mesh.positions,
                                mesh.indices, level.indices.size() / 3, options)
                      .upper;
  });
  for (std::vector<MeshLevel>& levels : of_mesh)
    for (MeshLevel& level : levels) level.error = 0;
  for (const Job& job : jobs) {
    MeshLevel& level = of_mesh[job.mesh][job.level];
    level.error = std::max(level.error, job.upper);
  }
  for (const std::size_t i : leveled) {
    const double useful = kUseful * double(scene.meshes[i].bounds.radius());
    std::vector<MeshLevel> kept;  // a coarser level that is no farther away is better
    for (std::size_t k = of_mesh[i].size(); k-- > 0;)
      if (of_mesh[i][k].error <= useful &&
          (kept.empty() || of_mesh[i][k].error < kept.back().error))
        kept.push_back(std::move(of_mesh[i][k]));
    std::reverse(kept.begin(), kept.end());
    of_mesh[i] = std::move(kept);
  }
}

// Puts the levels' meshes behind the scene's own. Level k of mesh i is mesh first_of[i] + k.
std::vector<int> add_meshes(const Scene& scene, std::vector<std::vector<MeshLevel>>& of_mesh,
                            Scene& out) {
  std::vector<int> first_of(scene.meshes.size());
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    first_of[i] = int(out.meshes.size());
    for (MeshLevel& level : of_mesh[i])
      out.meshes.push_back(compact_mesh(scene.meshes[i], std::move(level.indices)));
  }
  return first_of;
}

}  // namespace

double largest_stretch(const glm::mat4& m) {
  // The largest eigenvalue of a symmetric matrix is at most the largest sum of a row.
  const glm::dmat3 axes(m), gram = glm::transpose(axes) * axes;
  double largest = 0;
  for (int i = 0; i < 3; ++i)
    largest = std::max(largest, std::abs(gram[i][0]) + std::abs(gram[i][1]) + std::abs(gram[i][2]));
  return std::sqrt(largest);
}

LeveledScene make_levels(const Scene& scene, const LevelsOptions& options) {
  LeveledScene leveled{scene, {}};
  Scene& out = leveled.scene;
  std::vector<std::vector<MeshLevel>> of_mesh(scene.meshes.size());
  parallel_for(std::size_t(0), scene.meshes.size(),
               [&](std::size_t i) { of_mesh[i] = mesh_levels(scene.meshes[i], options); });
  const std::vector<int> first_of = add_meshes(scene, of_mesh, out);
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    std::vector<ModelLevel>& levels = leveled.levels.emplace_back();
    levels.push_back({int(m), 0});
    const Model& model = scene.models[m];
    std::size_t most = 0;
    for (const Part& part : model.parts)
      most = std::max(most, of_mesh[std::size_t(part.mesh)].size());
    for (std::size_t k = 1; k <= most; ++k) {
      Model coarse = model;
      double error = 0;
      for (Part& part : coarse.parts) {
        const std::vector<MeshLevel>& all = of_mesh[std::size_t(part.mesh)];
        const std::size_t level = std::min(k, all.size());
        if (level == 0) continue;
        error = std::max(error, largest_stretch(part.model_from_mesh) * all[level - 1].error);
        part.mesh = first_of[std::size_t(part.mesh)] + int(level) - 1;
      }
      levels.push_back({int(out.models.size()), error});
      out.models.push_back(std::move(coarse));
    }
  }
  finish(out);
  return leveled;
}

LeveledScene make_bounded_levels(const Scene& scene, const LevelsOptions& options) {
  LeveledScene leveled{scene, {}};
  Scene& out = leveled.scene;
  std::vector<std::vector<MeshLevel>> of_mesh(scene.meshes.size());
  parallel_for(std::size_t(0), scene.meshes.size(), [&](std::size_t i) {
    if (may_be_bounded(scene, scene.meshes[i])) of_mesh[i] = mesh_levels(scene.meshes[i], options);
  });
  bound_levels(scene, of_mesh);
  const std::vector<int> first_of = add_meshes(scene, of_mesh, out);
  const auto triangles = [&](int mesh) { return out.meshes[std::size_t(mesh)].primitives(); };
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    std::vector<ModelLevel>& levels = leveled.levels.emplace_back();
    levels.push_back({int(m), 0});
    const Model& model = scene.models[m];
    std::vector<double> errors;  // at which some part becomes coarser
    double last = 0;             // triangles
    for (const Part& part : model.parts) {
      last += double(triangles(part.mesh));
      for (const MeshLevel& level : of_mesh[std::size_t(part.mesh)])
        errors.push_back(largest_stretch(part.model_from_mesh) * level.error);
    }
    std::sort(errors.begin(), errors.end());
    for (const double error : errors) {
      Model coarse = model;
      double count = 0;
      for (Part& part : coarse.parts) {
        const std::vector<MeshLevel>& all = of_mesh[std::size_t(part.mesh)];
        const double stretch = largest_stretch(part.model_from_mesh);
        std::size_t k = 0;  // levels that are fine enough: their errors grow
        while (k < all.size() && stretch * all[k].error <= error) ++k;
        if (k > 0) part.mesh = first_of[std::size_t(part.mesh)] + int(k) - 1;
        count += double(triangles(part.mesh));
      }
      if (count > kFewer * last) continue;
      last = count;
      levels.push_back({int(out.models.size()), error});
      out.models.push_back(std::move(coarse));
    }
  }
  finish(out);
  for (const std::vector<ModelLevel>& levels : leveled.levels)
    for (const ModelLevel& level : levels)
      out.models[std::size_t(level.model)].bounds = out.models[std::size_t(levels[0].model)].bounds;
  return leveled;
}

const ModelLevel& choose_level(const std::vector<ModelLevel>& levels, double allowed) {
  RILIEVO_EXPECTS(!levels.empty());
  std::size_t chosen = 0;
  while (chosen + 1 < levels.size() && levels[chosen + 1].error <= allowed) ++chosen;
  return levels[chosen];
}

}  // namespace rilievo

#include "rilievo/scene/levels.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

struct MeshLevel {
  std::vector<std::uint32_t> indices;
  double error = 0;  // mesh space
};

// Of what is asked for, a level has at most this share more.
constexpr double kReached = 1.2;

MeshLevel simplify_mesh(const Mesh& mesh, const std::vector<std::uint32_t>& indices,
                        std::size_t target) {
  const float* positions = &mesh.positions[0].x;
  const std::size_t count = mesh.positions.size(), stride = sizeof(glm::vec3);
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
  return level;
}

std::vector<MeshLevel> mesh_levels(const Mesh& mesh, const LevelsOptions& options) {
  std::vector<MeshLevel> levels;
  const std::vector<std::uint32_t>* finer = &mesh.indices;
  double error = 0;
  while (int(levels.size()) < options.max_levels &&
         finer->size() / 3 >= std::max<std::uint64_t>(2 * options.min_triangles, 2)) {
    MeshLevel level = simplify_mesh(mesh, *finer, finer->size() / 6 * 3);
    if (level.indices.empty() || level.indices.size() > finer->size() * 9 / 10) break;
    // Each level is made from the one before: their errors add up.
    error += level.error;
    level.error = error;
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

}  // namespace

double largest_scale(const glm::mat4& m) {
  return double(std::max(
      {glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))}));
}

LeveledScene make_levels(const Scene& scene, const LevelsOptions& options) {
  LeveledScene leveled{scene, {}};
  Scene& out = leveled.scene;
  std::vector<std::vector<MeshLevel>> of_mesh(scene.meshes.size());
  parallel_for(std::size_t(0), scene.meshes.size(),
               [&](std::size_t i) { of_mesh[i] = mesh_levels(scene.meshes[i], options); });
  // Level k of a mesh, k from 1 on, is mesh first_of[i] + k - 1.
  std::vector<int> first_of(scene.meshes.size());
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    first_of[i] = int(out.meshes.size());
    for (MeshLevel& level : of_mesh[i])
      out.meshes.push_back(compact_mesh(scene.meshes[i], std::move(level.indices)));
  }
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
        error = std::max(error, largest_scale(part.model_from_mesh) * all[level - 1].error);
        part.mesh = first_of[std::size_t(part.mesh)] + int(level) - 1;
      }
      levels.push_back({int(out.models.size()), error});
      out.models.push_back(std::move(coarse));
    }
  }
  finish(out);
  return leveled;
}

const ModelLevel& choose_level(const std::vector<ModelLevel>& levels, double allowed) {
  RILIEVO_EXPECTS(!levels.empty());
  std::size_t chosen = 0;
  while (chosen + 1 < levels.size() && levels[chosen + 1].error <= allowed) ++chosen;
  return levels[chosen];
}

}  // namespace rilievo

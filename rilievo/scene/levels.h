// Coarser levels of detail of a scene.
//
// Each mesh simplified again and again, to half of its triangles at a time, by meshoptimizer. A
// level's error is what meshoptimizer states, a distance, or what its normals are off by
// (shading_error.h) where that is more; it is no bound, but for bounded levels.
// Vertices are shared with the mesh, so that a level keeps its attributes. Where edges and seams
// allow no more, the sloppy variant goes on, which keeps no topology.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/scene/scene.h"

namespace rilievo {

// A model in place of a finer one.
struct ModelLevel {
  int model = 0;     // index into Scene::models
  double error = 0;  // model space, metres
};

// A scene with coarser models behind its own, which no object uses yet.
struct LeveledScene {
  Scene scene;
  std::vector<std::vector<ModelLevel>> levels;  // by model of the scene given; the finest first
};

// When to stop.
struct LevelsOptions {
  int max_levels = 10;
  std::uint64_t min_triangles = 24;  // smaller meshes stay as they are
  // Of a mesh's finest level; 0: any. Half of a mesh of millions takes seconds, and a small share
  // of it at once takes less than that.
  std::uint64_t most_triangles = 0;
};

// Makes the levels of all models, on all cores. The result does not depend on the number of
// threads.
[[nodiscard]] LeveledScene make_levels(const Scene& scene, const LevelsOptions& options = {});

// Levels whose errors are bounds (mesh_distance.h): each point of an opaque surface of the model is
// at most so far from the nearest point of the level, and the other way. Each part is as coarse as
// the error allows. Masked and blended parts stay as they are, because what the mask leaves of a
// level is not bounded; so do models whose bounds would take too long. On all cores, with the same
// result for any number of threads. Models keep the bounds of their finest level.
[[nodiscard]] LeveledScene make_bounded_levels(const Scene& scene,
                                               const LevelsOptions& options = {});

// A distance grows by at most this, an upper bound; exact where the axes are orthogonal.
[[nodiscard]] double largest_stretch(const glm::mat4& transform);

// The coarsest level with an error of at most `allowed` metres in model space.
[[nodiscard]] const ModelLevel& choose_level(const std::vector<ModelLevel>& levels, double allowed);

}  // namespace rilievo

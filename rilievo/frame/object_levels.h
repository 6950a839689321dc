// The level of detail of each object of a frame, for baselines by OpenGL and without.
//
// Each object by the coarsest of its levels (scene/levels.h) whose error appears at most so many
// pixels large at the nearest point of its bounds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera.h"
#include "rilievo/scene/levels.h"

namespace rilievo {

// A scene whose objects show some of its levels.
struct ObjectLevels {
  LeveledScene leveled;
  std::vector<int> model_of;  // by object: of the finest level
};

// All objects by their finest levels.
[[nodiscard]] ObjectLevels make_object_levels(const Scene& scene,
                                              const LevelsOptions& options = {});

// The same with errors that are bounds (make_bounded_levels).
[[nodiscard]] ObjectLevels make_bounded_object_levels(const Scene& scene);

// Makes an object show its coarsest level that is at most `error` metres off where it is placed.
void show_level(std::uint32_t object, const glm::mat4& pose, double error, ObjectLevels& levels);

// Makes `objects`, placed by `poses` within `bounds` (of all objects), show the levels that they
// have for `camera`. Returns the largest error of a level, in pixels.
double choose_levels(const Camera& camera, std::span<const std::uint32_t> objects,
                     std::span<const glm::mat4> poses, std::span<const Box> bounds, double error_px,
                     ObjectLevels& levels);

}  // namespace rilievo

// Which place of a model does a pixel show? Colours that tell positions, for measures.
//
// In a copy of the scene each surface shows the code of its position in model space instead of its
// colour: three triangle waves along three orthogonal directions, one for each channel,
//
//     t = D p / h       byte = 255 (1 - |(t mod 2) - 1|)
//
// D: code_directions(); h: the half period of the model, metres. Drawing is otherwise the same:
// meshes, motion, masks and sides. The waves are linear in what frames and pictures store (bytes of
// sRGB), so that antialiasing and filters average positions, except at the folds of a wave. None of
// D's directions is an axis: on a wall along the axes, all three waves run. Blended parts show
// nothing. Pure; any thread.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rilievo/core/color.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The directions of the three waves, as rows: a rotation.
[[nodiscard]] const glm::dmat3& code_directions();

// A copy of the scene that shows positions. `half_periods`: one for each model, positive, metres in
// its space.
[[nodiscard]] Scene with_position_colors(const Scene& scene, std::span<const double> half_periods);

// On a rising or a falling slope of each of three waves.
inline constexpr int kCodeCandidates = 8;
// The place that shows `color` and is nearest to `guess` on these slopes, 0 <= candidate <
// kCodeCandidates. Model space.
[[nodiscard]] glm::dvec3 decode_position(const glm::u8vec4& color, const glm::dvec3& guess,
                                         double half_period, int candidate);

}  // namespace rilievo

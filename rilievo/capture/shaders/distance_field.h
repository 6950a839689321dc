// Which content has no triangles? Surfaces that signed distances describe, by name.
//
// A field is negative inside, and never changes by more than the way that one goes (it is Lipschitz
// continuous with 1), so that a ball as large as its value holds no surface. Pure; any thread.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string_view>

#include "rilievo/core/bounds.h"

namespace rilievo {

// A signed distance, or less than it.
struct DistanceField {
  std::string_view name;
  double (*distance)(const glm::dvec3&) = nullptr;
  Box bounds;  // around everything where the distance is negative
};

// torus, gyroid (a shell in a ball), menger (a sponge); about two units large, around the origin.
[[nodiscard]] std::span<const DistanceField> distance_fields();
// Null if there is none of that name.
[[nodiscard]] const DistanceField* find_distance_field(std::string_view name);

// The unit direction in which the distance grows, by differences over `step`.
[[nodiscard]] glm::dvec3 distance_normal(const DistanceField& field, const glm::dvec3& at,
                                         double step);

// The first t in [0, length] at which origin + t * direction (unit) is at most `precision` from the
// surface or inside, by sphere tracing [Hart 1996]; negative if there is none.
[[nodiscard]] double trace_field(const DistanceField& field, const glm::dvec3& origin,
                                 const glm::dvec3& direction, double length, double precision);

}  // namespace rilievo

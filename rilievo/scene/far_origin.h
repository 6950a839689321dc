// Finds an origin for coordinates that lie far from 0 (core/world_space.h). Internal to loading.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace rilievo {

// An origin in the middle of most of `points` (finite, any order), rounded to multiples of a power
// of two about as large as their spread. 0 if single precision serves them: the centre of their box
// is at most 16 radii away from 0, and their median at most 256 times their median deviation.
[[nodiscard]] glm::dvec3 far_origin(std::vector<glm::dvec3> points);

}  // namespace rilievo

// Finds an origin for coordinates that lie far from 0 (core/world_space.h). Internal to loading.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace rilievo {

// An origin in the middle of most of `points` (finite, any order), rounded to a power of two about
// as large as they spread. 0 where single precision serves them all as well: they are not 16 times
// as far from 0 as they reach, nor most of them 256 times as far as they spread.
[[nodiscard]] glm::dvec3 far_origin(std::vector<glm::dvec3> points);

}  // namespace rilievo

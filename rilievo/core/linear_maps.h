// Which linear maps mirror, which can be inverted, and how do they carry normals?
//
// Of the linear part of a placement. In doubles: the volume of what is small underflows in floats.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace rilievo {

// Does the map turn right hands into left ones? Not if it has no volume.
[[nodiscard]] inline bool is_mirroring(const glm::dmat3& m) { return glm::determinant(m) < 0; }

// Can the map be inverted in single precision? Not if it makes everything flat, a line or a point;
// nor if numbers of its inverse, multiplied a few times, leave the range of a float.
[[nodiscard]] inline bool is_invertible(const glm::dmat3& m) {
  const double longest = std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
  if (!(longest > 1e-9 && longest < 1e9)) return false;
  const double volume = glm::determinant(m / longest);
  // 1e-9: flattened a billion times, or 30 000 times in two directions.
  return volume > 1e-9 || volume < -1e-9;
}

// Carries normals of a surface: at right angles to it after the map, on the side that was outside,
// of any length. It is the cofactor matrix, which is the inverse transpose times the determinant
// and exists where that does not: what is flattened to a sheet has the sheet's normal, or none (0)
// where the surface stood upright on it.
[[nodiscard]] inline glm::dmat3 normal_map(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]),
                             glm::cross(m[0], m[1]));
  return is_mirroring(m) ? -cofactors : cofactors;
}

}  // namespace rilievo

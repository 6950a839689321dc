// Writes coordinates for people: with as many digits as the size of a thing asks for, however far
// from 0 it lies.
#pragma once

#include <glm/glm.hpp>
#include <string>

namespace rilievo {

// "X Y Z": each number with four digits, and more where those would be coarser than a thousandth of
// `size` (of the thing that is there, in the same unit; positive).
[[nodiscard]] std::string place_text(const glm::dvec3& place, double size);

}  // namespace rilievo

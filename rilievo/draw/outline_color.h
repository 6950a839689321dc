// The colour of the outlines around what is drawn from pictures (S1.8).
#pragma once

#include <glm/glm.hpp>

namespace rilievo {

inline constexpr glm::vec3 kOutlineColor{1.0f, 0.85f, 0.1f};  // sRGB

}  // namespace rilievo

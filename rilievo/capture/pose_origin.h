// An origin for cameras that lie far from 0 (core/world_space.h).
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rilievo/core/world_space.h"

namespace rilievo {

// Subtracts an origin from poses (world_from_eye, metres) where single precision would not serve
// what the cameras see, and returns the space that they count from then; the world's itself, and
// poses as they were, where it does.
[[nodiscard]] WorldSpace take_origin_off(std::span<glm::dmat4* const> poses);

}  // namespace rilievo

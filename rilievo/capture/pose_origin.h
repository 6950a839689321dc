// An origin for cameras that lie far from 0 (core/world_space.h).
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rilievo/core/world_space.h"

namespace rilievo {

// Subtracts an origin from poses (world_from_eye, metres) that lie too far from 0 for what the
// cameras see to be kept in single precision. Returns the space that the poses count from. Poses
// near 0 stay as they are; the origin is then 0.
[[nodiscard]] WorldSpace take_origin_off(std::span<glm::dmat4* const> poses);

}  // namespace rilievo

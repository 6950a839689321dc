// Where a person can stand in a scene, and look around: where a walk begins that nobody planned.
//
// Columns of the scene's middle tell where there is ground with room above it, about level; from
// some of these places a few rays tell how far one sees. The best one is where most things are
// seen, and not too near: a street, not the inside of a wall. World space, metres, y up.
#pragma once

#include <optional>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/camera.h"

namespace rilievo {

// A camera at a person's eye, as wide as others in the library are, of 1 x 1 texel. None where the
// scene is too small to walk in (less than kLeastWalk either way), where nobody can stand, and of
// sources that do not know hidden surfaces.
inline constexpr double kLeastWalk = 5;
[[nodiscard]] std::optional<Camera> standing_place(CaptureSource& source);

}  // namespace rilievo

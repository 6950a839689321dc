// How densely do the lines of sight of pictures hit a face, whichever way it looks?
#pragma once

#include <span>

#include "rilievo/core/camera.h"

namespace rilievo {

// How far from a point of a flat face is the nearest hit of a line of sight on it, at most,
// whichever way the face looks? World space, metres. The cameras are parallel; each face counts by
// the one that samples it best. Infinite if some face is seen edge-on by all.
[[nodiscard]] double farthest_from_hits(std::span<const Camera> cameras);

}  // namespace rilievo

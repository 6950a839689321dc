// Which space behind the surface do the pictures of an object not see?
//
// A picture sees the space between its viewers and its surface to be empty, and nothing of what is
// behind. A point that no picture sees to be empty is inside the object, or so hidden that nobody
// knows better: whatever is drawn there covers nothing that a picture holds. Slices are made solid
// with it (layered_impostor.h): who looks into a crack, past the edges of everything that is
// pictured, meets the inside of the object and not what stands behind it.
//
// Depths: eye_z of each picture's camera, metres. Same result for any number of threads.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// Does the picture see this point (world) to be empty? Not outside of its frustum.
[[nodiscard]] bool seen_empty(const TexelSurface& surface, const glm::dvec3& world);

// Sets SurfaceTexel::inside of all texels: down to there, no picture sees the space behind the
// texel's surface to be empty. For that some 64 x 64 lines of sight of every picture are followed,
// whatever its size, in steps of a 64th of its frustum's depth; each stands for the texels around
// it.
void find_inside(std::span<TexelSurface> surfaces);

}  // namespace rilievo

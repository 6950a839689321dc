// Which space behind the surface do an object's pictures not see? Free-space carving.
//
// A picture shows that the space between its viewers and its surface is free; it tells nothing
// about the space behind. A point that no picture carves lies in the object's visual hull: drawing
// something there hides nothing that a picture shows. Slices extend into the hull and become solid
// (layered_impostor.h), so that an eye that looks into a crack, past the edges of everything
// captured, sees the inside of the object and not the background.
//
// Depths: eye_z of each picture's camera, metres. The result does not depend on the number of
// threads.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// Does the picture carve this point (world space)? Never outside of its frustum.
[[nodiscard]] bool is_carved(const TexelSurface& surface, const glm::dvec3& world);

// Sets SurfaceTexel::inside of all texels: the depth down to which no picture carves the space
// behind the texel's surface. Follows 64 x 64 lines of sight of each picture, whatever its size, in
// steps of 1/64 of its frustum's depth; each stands for the texels around it.
void find_visual_hulls(std::span<TexelSurface> surfaces);

}  // namespace rilievo

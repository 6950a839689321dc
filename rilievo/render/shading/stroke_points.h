// Where does a ray of a picture meet a point or a line?
//
// A point is a disc that faces the eye, or, if its size is in pixels, the image; a line has the
// depth of its nearest place in the image. Requires that the picture shows the primitive at the ray
// (render/raster/stroke_setup.inl decides that). Positions are relative to the camera's. Any
// thread.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/render/shading/surface.h"

namespace rilievo {

// A place on a point or on a line.
struct StrokePoint {
  glm::vec3 relative{0.0f};
  std::uint32_t vertex[2] = {0, 0};  // of the mesh; the same of a point
  float share = 0;                   // of the second
};

// Where `ray`, as PictureRays has it, meets primitive `index` of the mesh.
[[nodiscard]] StrokePoint stroke_at(const PictureRays& rays, const glm::vec3& ray, const Mesh& mesh,
                                    const SurfacePlacement& placement, std::uint32_t index);

// Corners of a triangle around a place, which faces the camera's rays.
struct FacingCorners {
  glm::vec3 at[3];
};
[[nodiscard]] FacingCorners facing_corners(const PictureRays& rays, const glm::vec3& relative);

// The placement for what is relative to the camera already.
[[nodiscard]] SurfacePlacement unplaced(const SurfacePlacement& placement);

}  // namespace rilievo

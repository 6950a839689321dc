// Which rays of a picture's capture does a frame see, in the capture's eye space? Internal to
// `nailboard`.
//
// Shared by the bounds of a picture's errors. Pure, no allocation.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <limits>

#include "rilievo/core/camera.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/nailboard/error.h"

namespace rilievo {

// The bound of a picture for which nothing can be promised.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The frame as seen from the picture: pixel rows and eye in the capture's eye space. A point A
// appears at the pixel (x.(A-eye), y.(A-eye)) / f.(A-eye).
struct ViewOfPicture {
  glm::dvec3 x, y, f, eye;
  double t = 0;  // f.eye
};

// The view of `frame`, with the object's motion since the capture.
[[nodiscard]] ViewOfPicture view_of(const Camera& frame, const PictureGeometry& picture,
                                    const RigidMotion& motion);

// Are the axes orthonormal (to 1e-4) and not mirrored?
[[nodiscard]] bool is_rigid(const glm::dmat4& m);

// A convex polygon of capture rays (x, y, -1). The window has 4 corners; each cut adds at most 1.
struct RayPolygon {
  std::array<glm::dvec2, 12> corner;
  int size = 0;
};

// A polygon that contains all rays whose cell of half size `half` (tangents) has a point in the
// frame at a distance in [front, back].
[[nodiscard]] RayPolygon rays_in_frame(const PictureGeometry& picture, const Camera& frame,
                                       const ViewOfPicture& view, double front, double back,
                                       const glm::dvec2& half);

}  // namespace rilievo

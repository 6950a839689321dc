// Which camera do OpenEXR's standard attributes `worldToCamera` and `worldToNDC` describe?
//
// OpenEXR multiplies row vectors from the left; in memory that is what GLM holds for column
// vectors on the right, so the matrices here are GLM's and are stored element by element.
//   worldToCamera  to OpenEXR's left-handed camera space: x right, y up, z forward (so z = eye_z)
//   worldToNDC     to the display window: after the division (0, 0) is its upper left corner and
//                  (1, 1) its lower right one; OpenEXR leaves z open, here it is window_z
// Both are floats in the file.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo {

struct StandardMatrices {
  glm::dmat4 camera_from_world{1.0};  // worldToCamera
  glm::dmat4 ndc_from_world{1.0};     // worldToNDC
};

[[nodiscard]] StandardMatrices standard_matrices(const Camera& camera);

// The perspective or parallel camera behind two matrices; its size and z_near, z_far are left at
// their defaults, because the matrices do not say. Beside the documented convention two common
// deviations are recognised by their signs: camera spaces that look down -z, and an NDC that
// reaches from -1 to 1 with y up (RenderMan's screen space). Fails on matrices that are not
// finite, not a rigid pose (to 1e-3), not a projection from that pose, or mirrored.
[[nodiscard]] Result<Camera> camera_from_standard(const StandardMatrices& matrices);

}  // namespace rilievo

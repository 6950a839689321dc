// Which camera do OpenEXR's standard attributes `worldToCamera` and `worldToNDC` describe?
//
// OpenEXR multiplies row vectors from the left. The same numbers in memory are GLM's matrix for
// column vectors on the right, so the matrices here are GLM's and are stored element by element.
//   worldToCamera  to OpenEXR's left-handed camera space: x right, y up, z forward (so z = eye_z)
//   worldToNDC     to the display window: after the division, (0, 0) is its upper left corner and
//                  (1, 1) its lower right one; OpenEXR leaves z open, here it is window_z
// Both are floats in the file.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo {

// The two matrices, in GLM's convention.
struct StandardMatrices {
  glm::dmat4 camera_from_world{1.0};  // worldToCamera
  glm::dmat4 ndc_from_world{1.0};     // worldToNDC
};

// The matrices of a camera.
[[nodiscard]] StandardMatrices standard_matrices(const Camera& camera);

// The perspective or parallel camera with these matrices; its size, z_near and z_far keep their
// defaults, because the matrices do not contain them. Besides the documented convention, two common
// deviations are recognised by their signs: camera spaces that look down -z, and an NDC from -1 to
// 1 with y up (RenderMan's screen space). Fails on matrices that are not finite, mirrored, not a
// rigid pose (to 1e-3), or not a projection from that pose.
[[nodiscard]] Result<Camera> camera_from_standard(const StandardMatrices& matrices);

}  // namespace rilievo

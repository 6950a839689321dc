// A camera from a host program's matrices, and how the host's depth buffer relates to it.
//
// A perspective projection has four numbers about depth and position, and c, e:
//
//     clip = | a 0 s 0 |  eye        with d = eye_z = -z:   ndc_z = -c + e / d
//            | 0 b t 0 |
//            | 0 0 c e |
//            | 0 0 -1 0 |
//
// ndc_z grows with d where e < 0; where e > 0, z is reversed. The planes are where ndc_z takes the
// ends of its range, so that c and e give both planes once the range is known: [-1, 1], OpenGL's,
// or [0, 1]. A matrix cannot tell the range, since each pair of numbers is some camera's in both:
// the host says it.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"

namespace rilievo {

// The range of z in a host's clip space, after the division.
enum class ClipRange {
  minus_one_to_one,  // OpenGL's
  zero_to_one,       // glClipControl(..., GL_ZERO_TO_ONE), Direct3D, Metal
};

// A host's camera.
struct HostCamera {
  Camera camera;
  bool reversed = false;  // nearer is larger in the host's depth buffer
  // The host's window depth is depth_offset + depth_scale / eye_z.
  double depth_offset = 0, depth_scale = 0;
};

// The far plane of a camera whose projection has none: so many times its near plane.
inline constexpr double kFarOfInfinite = 1e6;

// The camera of `eye_from_world` (the host's view matrix) and `clip_from_eye` (its projection), for
// a frame of `width` times `height` pixels. z can be reversed, and the far plane infinite. Fails
// where these are no perspective camera's: a view that scales, shears or mirrors, a projection that
// is parallel or upside down, or whose planes are not 0 < near < far in this range.
[[nodiscard]] Result<HostCamera> camera_from(const glm::dmat4& eye_from_world,
                                             const glm::dmat4& clip_from_eye, int width, int height,
                                             ClipRange range = ClipRange::minus_one_to_one);

}  // namespace rilievo

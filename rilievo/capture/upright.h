// Which way is up in a capture, and from where is it best viewed? (S2.7)
//
// The world space of a capture is often that of its first camera, or arbitrary. But people hold
// cameras level: they pan in all directions, tilt by some twenty-five degrees, and roll by a few.
// So in each pose, `up` is about perpendicular to the camera's x axis, and less reliably so to its
// z axis.
//
// World space of the capture. Pure.
#pragma once

#include <span>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/depth_image.h"

namespace rilievo {

// The unit direction that is up. Tolerates nearly half of the cameras being held otherwise. For one
// camera it is that camera's y axis, for none +y. It is wrong if most cameras were held sideways or
// all were tilted alike, which poses do not tell.
[[nodiscard]] glm::dvec3 estimate_up(std::span<const Camera> cameras);

// The vantage of a capture. The gaze is that of the most central photograph: from its eye along its
// axis to the median depth of its samples in `box`. There is no gaze if no photograph has samples
// there, or if that photograph looks straight up or down.
[[nodiscard]] Vantage estimate_vantage(std::span<const DepthImage> photographs, const Box& box);

}  // namespace rilievo

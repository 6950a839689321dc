// Which way is up in a capture, and from where is it best looked at? (S2.7)
//
// A capture's world is often the first camera's, or anything else. But people hold cameras level:
// they turn to all sides, nod by some twenty-five degrees, and roll by a few. So each pose says of
// `up` that it is about at right angles to the camera's x axis, and less surely to its z axis.
//
// World space of the capture. Pure.
#pragma once

#include <span>

#include "rilievo/core/bounds.h"
#include "rilievo/core/camera_path.h"
#include "rilievo/core/depth_image.h"

namespace rilievo {

// Unit. Up to nearly half of the cameras may be held otherwise. Of one camera its own y axis; of
// none +y. What cannot be known from poses: if most were held sideways, or all nod alike, the
// answer is off by as much.
[[nodiscard]] glm::dvec3 estimate_up(std::span<const Camera> cameras);

// With a gaze, that of the photograph in the middle of all: from its eye along its axis, as far as
// half of its samples in `box` are. No gaze if no photograph has samples there, or that one looks
// straight up or down.
[[nodiscard]] Vantage estimate_vantage(std::span<const DepthImage> photographs, const Box& box);

}  // namespace rilievo

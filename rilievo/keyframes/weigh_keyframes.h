// How much each keyframe counts in a frame that is warped from several.
#pragma once

#include <span>

#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// The distance between the eyes of a keyframe and of a frame.
[[nodiscard]] double eye_distance(const Keyframe& keyframe, const Camera& frame);

// The inverse square of a keyframe's eye's distance over `sum`, that of all keyframes; next to
// nothing of a coarse one.
[[nodiscard]] float keyframe_weight(const Keyframe& keyframe, const Camera& frame, double sum);

// Makes those that count little spare. The others lose as much, so that none comes or goes at once.
void spare_weak(std::span<WarpedKeyframe> keyframes);

}  // namespace rilievo

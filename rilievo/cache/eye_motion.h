// Where will the eye be in the next frames, judging by the last ones?
//
// World space, metres and radians a frame.
#pragma once

#include "rilievo/cache/policy.h"

namespace rilievo {

// What is remembered of the last frames. Start with an empty one.
struct EyeMotion {
  int frames = 0;  // seen so far
  Camera last;
  glm::dvec3 step{0.0}, turn{0.0};  // from the frame before the last to the last
};

// The view for a frame by `camera`, and remembers it. The eye is expected to go on as in its last
// step, but no faster than in the step before: a jump is not a motion.
[[nodiscard]] FrameView follow(EyeMotion& motion, const Camera& camera);

}  // namespace rilievo

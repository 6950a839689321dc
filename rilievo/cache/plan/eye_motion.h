// The eye's place in the next frames, judged by the last ones.
//
// World space; metres and radians per frame.
#pragma once

#include "rilievo/cache/plan/policy.h"

namespace rilievo {

// The motion seen so far. Start with an empty one.
struct EyeMotion {
  int frames = 0;  // seen so far
  Camera last;
  glm::dvec3 step{0.0}, turn{0.0};  // from the frame before the last to the last
  // Lengths of the longest so far, jumps left out.
  double longest_step = 0, longest_turn = 0;
};

// Records `camera` and returns the view of its frame. The prediction repeats the last step, but is
// no faster than the step before it: a jump is not a motion.
[[nodiscard]] FrameView follow(EyeMotion& motion, const Camera& camera);

}  // namespace rilievo

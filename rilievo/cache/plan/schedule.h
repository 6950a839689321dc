// Which of the requested pictures are captured in this frame?
#pragma once

#include "rilievo/cache/plan/frame_planner.h"

namespace rilievo {

// Grants the requests in cut.scratch.requests by deadline, as far as the budget, the memory and an
// even pace allow. Fills plan.captures, plan.evictions, credit and texel_scale.
void schedule_captures(FramePlanner& planner);

}  // namespace rilievo

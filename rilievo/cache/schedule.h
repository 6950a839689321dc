// Which of the pictures that are wanted are captured in this frame?
#pragma once

#include "rilievo/cache/cut.h"

namespace rilievo {

// Takes cut.scratch.requests in the order of their deadlines as far as the budget, the memory and
// an even pace allow; fills plan.captures, plan.evictions, credit, texel_scale.
void schedule_captures(Cut& cut);

}  // namespace rilievo

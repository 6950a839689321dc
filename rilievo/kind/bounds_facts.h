// Describes where a baked kind lies in the world.
#pragma once

#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// "bounds_min" and "bounds_max", metres of the world. `bounds` are in the space that `world`
// places.
[[nodiscard]] std::vector<Fact> bounds_facts(const Box& bounds, const WorldSpace& world);

}  // namespace rilievo

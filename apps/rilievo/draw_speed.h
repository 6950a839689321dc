// OpenGL or software: which draws faster on this machine?
//
// Both draw a small scene of polygons first, for half a second. What they took is kept in
// $XDG_CACHE_HOME/rilievo/draw_speed.json, or in ~/.cache, for runs of the same build on the same
// machine, for a day, or for a month if it agrees with the one before (kept_speed.h). What other
// builds and machines measured stays there, too. Where no file can be kept it is measured in each
// run.
#pragma once

#include <optional>

#include "rilievo/cache/prices/machine_costs.h"

namespace rilievo::app {

// Do frames of so many triangles and pixels take less without OpenGL? By the costs of --machine if
// there are some. Software where the two are close: its frames are the same bytes on all machines.
// Needs a current OpenGL context. Fails where the driver does.
[[nodiscard]] Result<bool> software_is_faster(double triangles, double pixels,
                                              const std::optional<MachineCosts>& machine);

}  // namespace rilievo::app

// Measures how long frames, captures and rays take without OpenGL, on this machine.
#pragma once

#include "rilievo/cache/prices/machine_costs.h"

namespace rilievo {

// Measures them on all cores, in about half a second on two. Leaves out what names the machine, and
// OpenGL. Fails if memory does not suffice.
[[nodiscard]] Result<MachineCosts> measure_software();

// The time of polygons alone; a tenth of a second, likewise.
[[nodiscard]] Result<PolygonTimes> measure_polygons_by_software();

}  // namespace rilievo

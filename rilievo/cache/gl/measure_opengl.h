// Measures how long frames and captures take with the OpenGL that is current.
#pragma once

#include "rilievo/cache/prices/machine_costs.h"

namespace rilievo {

// Measures them and adds them, and the renderer's name, to `costs`. A second or two where OpenGL
// runs on two cores. Needs a current OpenGL context. Fails where the driver does.
[[nodiscard]] Result<> measure_opengl(MachineCosts& costs);

// The time of polygons alone; some tenths of a second, likewise.
[[nodiscard]] Result<PolygonTimes> measure_polygons_by_opengl();

}  // namespace rilievo

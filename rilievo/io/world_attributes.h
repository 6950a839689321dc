// Where a file's pictures lie in the world, as an attribute of the file (io/exr.h): the cameras of
// the file are those of its scene space (core/world_space.h).
//
//   rilievo.file.world   "X Y Z up A unit M": the origin, the axis that was up (x, y, z), and the
//                        metres of a unit; absent where all are the defaults
#pragma once

#include "rilievo/core/world_space.h"
#include "rilievo/io/exr.h"

namespace rilievo {

void store_world(const WorldSpace& world, Attributes& file);
// The defaults where the file says nothing. The error has no file's name.
[[nodiscard]] Result<WorldSpace> world_from(const Attributes& file);

}  // namespace rilievo

// The driver of the OpenGL that is current.
#pragma once

#include <string>

namespace rilievo::gl {

// Its version as it states it, for example "4.5 (Core Profile) Mesa 23.1.4"; "none" if it does not.
// Needs a current OpenGL context.
[[nodiscard]] std::string driver_version();

}  // namespace rilievo::gl

// GLSL of the nailboard drawer.
#pragma once

#include "rilievo/gl/object.h"
#include "rilievo/represent/nailboard.h"

namespace rilievo::shader {

[[nodiscard]] Result<gl::Program> make_nailboard_program(DepthMode mode, bool objects);
[[nodiscard]] Result<gl::Program> make_outline_program();

}  // namespace rilievo::shader

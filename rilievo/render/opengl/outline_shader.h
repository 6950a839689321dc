// Which program draws the outlines of pictures (S1.8)? One colour for all.
#pragma once

#include <string>

#include "rilievo/gl/object.h"

namespace rilievo::shader {

// Links the outline's fragment shader with a complete vertex shader.
[[nodiscard]] Result<gl::Program> make_outline_program(const std::string& vertex);

}  // namespace rilievo::shader

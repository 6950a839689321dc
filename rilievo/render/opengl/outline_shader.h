// The lines around what is drawn from pictures (S1.8): all in one colour.
#pragma once

#include <string>

#include "rilievo/gl/object.h"

namespace rilievo::shader {

// `vertex`: a whole vertex shader.
[[nodiscard]] Result<gl::Program> make_outline_program(const std::string& vertex);

}  // namespace rilievo::shader

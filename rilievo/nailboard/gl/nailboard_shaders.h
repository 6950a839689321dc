// GLSL of the nailboard drawer.
#pragma once

#include "rilievo/gl/object.h"
#include "rilievo/nailboard/nailboard.h"

namespace rilievo::shader {

enum class NailboardOutput {
  color,
  share_of_color,  // a share of the pixels only, chosen by kPixelHash
  objects,         // identifiers
};

[[nodiscard]] Result<gl::Program> make_nailboard_program(DepthMode mode, NailboardOutput output);
[[nodiscard]] Result<gl::Program> make_nailboard_outline_program();

}  // namespace rilievo::shader

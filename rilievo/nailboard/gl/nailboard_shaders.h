// Which shaders draw nailboards?
#pragma once

#include "rilievo/gl/object.h"
#include "rilievo/nailboard/nailboard.h"

namespace rilievo::shader {

// What a program writes.
enum class NailboardOutput {
  color,
  share_of_color,  // the same within a cross-fade range (kPixelHash)
  objects,         // identifiers
};

// Compile the program of a depth mode and output, and that of outlines.
[[nodiscard]] Result<gl::Program> make_nailboard_program(DepthMode mode, NailboardOutput output);
[[nodiscard]] Result<gl::Program> make_nailboard_outline_program();

}  // namespace rilievo::shader

// The factories that draw each kind of representation with OpenGL.
#pragma once

#include <span>

#include "rilievo/representation/drawable_rows.h"

namespace rilievo {

// OpenGL's drawing of all kinds.
[[nodiscard]] std::span<const DrawableRow> drawable_rows();

}  // namespace rilievo

// The factories that draw each kind of representation without OpenGL.
#pragma once

#include <span>

#include "rilievo/representation/drawable_rows.h"

namespace rilievo {

// Drawing of all kinds into tiles (Drawable::tiles).
[[nodiscard]] std::span<const DrawableRow> software_drawable_rows();

}  // namespace rilievo

// How are layered impostors drawables? They share the shaders; each has its own pictures.
//
// Needs a current OpenGL context.
#pragma once

#include <memory>

#include "rilievo/kind/kind.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"

namespace rilievo {

// Compiles the shaders.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_layered_drawable_factory();

// A drawable from an impostor and typed options. `drawer` must outlive the drawable.
[[nodiscard]] Result<std::unique_ptr<Drawable>> make_layered_drawable(
    LayeredImpostor impostor, LayeredDrawer& drawer, const LayeredOptions& options);

}  // namespace rilievo

// Layered impostors as drawables: shaders once for all of them, pictures for each.
//
// Needs a current OpenGL context.
#pragma once

#include <memory>

#include "rilievo/kind/kind.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"

namespace rilievo {

[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_layered_drawable_factory();

// The same from an impostor and the options as a struct. `drawer` must outlive the drawable.
[[nodiscard]] Result<std::unique_ptr<Drawable>> make_layered_drawable(
    LayeredImpostor impostor, LayeredDrawer& drawer, const LayeredOptions& options);

}  // namespace rilievo

// Layered reliefs as drawables: each instance is warped for the frame's eye by the processors, and
// what comes out is drawn as nailboards (S4.10).
//
// Needs a current OpenGL context.
#pragma once

#include <memory>

#include "rilievo/kind/kind.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/nailboard/gl/prewarped_boards.h"

namespace rilievo {

// Fails if the driver refuses the memory or the shaders.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_relief_drawable_factory();

// The same from pictures and the options as a struct. `boards` must outlive the drawable.
[[nodiscard]] Result<std::unique_ptr<Drawable>> make_relief_drawable(const ReliefPictures& pictures,
                                                                     PrewarpedBoards& boards,
                                                                     const PrewarpOptions& options);

}  // namespace rilievo

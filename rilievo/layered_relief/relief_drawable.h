// Layered reliefs as drawables: each instance is warped for the frame's eye by the processors, and
// what comes out is drawn as nailboards (S4.10), with OpenGL or without.
#pragma once

#include <memory>

#include "rilievo/kind/kind.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/nailboard/prewarped_boards.h"

namespace rilievo {

// Draws from `boards`, which decide on the backend.
[[nodiscard]] std::unique_ptr<DrawableFactory> make_relief_factory(
    std::unique_ptr<PrewarpedBoards> boards);

// The same from pictures and the options as a struct. `boards` must outlive the drawable.
[[nodiscard]] Result<std::unique_ptr<Drawable>> make_relief_drawable(const ReliefPictures& pictures,
                                                                     PrewarpedBoards& boards,
                                                                     const PrewarpOptions& options);

}  // namespace rilievo

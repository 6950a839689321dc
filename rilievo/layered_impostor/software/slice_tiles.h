// How are the slices of layered impostors drawn without OpenGL (S2.3)?
//
// Each quad of a slice (slice_quads.h) lies in a plane: of a pixel's ray it takes one division to
// the texel, and the depth is the plane's at each sample. A pixel shows a texel in all samples that
// nothing nearer hides, as OpenGL's fragments do.
#pragma once

#include <memory>

#include "rilievo/kind/drawable.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Draws an impostor's slices into tiles.
[[nodiscard]] std::unique_ptr<Drawable> make_slice_tiles(LayeredImpostor impostor,
                                                         const LayeredOptions& options);

}  // namespace rilievo

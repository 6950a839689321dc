// How are layered impostors drawn without OpenGL, with the depth of what they show (S2.3)?
//
// By the height-field ray march of layered_impostor/gl: the rays of the pixels' centres through the
// surfaces of the nearest views, by the rules of warp_surfaces() (layered_impostor/warp.h), with
// colours that are encoded as frames are. All samples of a pixel show the same, but along
// silhouettes (silhouette_pixels.h): there the ray of each sample is marched, near the surfaces
// that the pixel and its neighbours show; and beside pixels of which samples alone show something,
// so that what is thinner than a pixel has no gaps. Pixels that something nearer hides are not
// marched.
#pragma once

#include <memory>

#include "rilievo/kind/kind.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// Draws an impostor into tiles; slices by slice_tiles.h.
[[nodiscard]] std::unique_ptr<Drawable> make_layered_tiles(LayeredImpostor impostor,
                                                           const LayeredOptions& options);

// The factory of the kind.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_layered_tiles_factory();

}  // namespace rilievo

// Which texels lie beside a picture's silhouettes? Internal to `layered_impostor/gl`.
//
// A shader sees of a pixel's neighbours no more than two. What passes between the centres of pixels
// is found by a ray through one of these centres nevertheless: it crosses a texel that shows
// nothing, but has a neighbour that shows something at about that depth. Pure.
#pragma once

#include "rilievo/core/image.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// For the texels that show nothing, the magnitude of the q of the front of the patches on the eight
// texels around them, and a texel's width before it, negative; 0 elsewhere, and where these show
// nothing either. By that width: rays end on the bounds, and where one of a pixel reaches a patch
// before them, another one may not.
[[nodiscard]] Image<float> silhouette_band(const TexelSurface& surface);

// Moves the fronts of cells, so that they are in front of the band as of the patches: rays are to
// cross its texels one by one. The cells' backs stay.
void add_band(const Image<float>& band, const TexelSurface& surface, const CellTexture& layout,
              Image<glm::vec2>& cells);

}  // namespace rilievo

// A mask seen from a distance: as much of each mip level passes as of the texture.
//
// The average of a leaf and of the air around it has too little alpha to pass a cutoff: of a
// texture whose leaves cover less than half, the small levels hold nothing, and trees stand bare
// from 15 m on. So each level's alpha is multiplied by the factor with which the share that passes
// comes nearest to that of level 0 [Castano 2010, Computing Alpha Mipmaps]. Where it must choose,
// as in the last levels, all or nothing passes.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/render/mip_chain.h"

namespace rilievo {

struct Material;

// The alpha of a material's texture at which its mask lets pass: cutoff over the material's own
// alpha (colours of vertices count as opaque). 0: there is nothing to keep, because the material
// has no mask, or all or nothing passes.
[[nodiscard]] float mask_threshold(const Material& material);

// The levels of a texture whose alpha is a mask. `srgb` as for build_mip_chain(). Requires
// 0 < threshold <= 1.
[[nodiscard]] MipChain build_mask_mip_chain(const Rgba8Image& texture, bool srgb, float threshold);

}  // namespace rilievo

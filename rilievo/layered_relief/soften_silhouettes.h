// Antialiases silhouettes of the picture that a pre-warp has made.
//
// A splat covers texels or not, so that silhouettes are stairs, and what splats of several textures
// cover together reaches beyond the surface. A texel's alpha is the share of what is covered around
// it, weighted by 1 2 1 across and down: along a straight silhouette it is 3/4, and on a line as
// wide as a texel 1/2.
#pragma once

#include "rilievo/nailboard/prewarped.h"

namespace rilievo {

// Multiplies colours by that alpha. Requires colours that are opaque where the picture shows
// something. Around the picture its border texels are repeated.
void soften_silhouettes(Prewarped& picture);

}  // namespace rilievo

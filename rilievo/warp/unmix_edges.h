// The texel rule (core/texel_rule.h) for pictures whose samples are gone: photographs, and what
// other programs rendered.
//
// A lens and a resolve mix the colours of both sides of a silhouette, but depth is that of one. The
// texels beside an unlinked neighbour (texel_links.h) are such edges. An edge's colour is c = (1 -
// t) a + t b + rest, with a the colour inside of its own surface, at most four texels away, b that
// behind or in front of the edge, and the rest orthogonal to b - a; it becomes a + rest. Surfaces
// that are nothing but edge keep their colours, and so do edges in front, which are antialiased.
#pragma once

#include "rilievo/core/depth_image.h"

namespace rilievo {

// Takes the colours of what is in front out of the texels behind edges. Alpha stays. The result
// does not depend on the number of threads.
void unmix_edges(DepthImage& picture);

}  // namespace rilievo

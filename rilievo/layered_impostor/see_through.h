// Pictures that see through a surface because they see it from behind: one-sided surfaces, as a
// lawn or a sheet of water, are drawn from in front only.
//
// Such a picture's empty texels do not say that nothing is there: an eye in front of the surface
// may be nearest to it, and see the surface all the same.
#pragma once

#include <span>
#include <vector>

#include "rilievo/capture/view_set.h"
#include "rilievo/warp/texel_surface.h"

namespace rilievo {

// For each picture: is there a neighbour of whose samples it should see some from behind, and has
// nothing there nor within two texels? Not if it misses as much that it should see from in front:
// then it lacks more than backs. Looks at 64 x 64 samples of each picture, whatever its size. Does
// not depend on the number of threads.
[[nodiscard]] std::vector<bool> find_seeing_through(const ViewSet& views,
                                                    std::span<const TexelSurface> surfaces);

}  // namespace rilievo

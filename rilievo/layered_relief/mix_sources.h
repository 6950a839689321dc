// One colour for samples of several pictures that lie side by side on one surface.
#pragma once

#include <vector>

#include "rilievo/layered_relief/known_sample.h"

namespace rilievo {

// Of `out`, which are those of `layers` and stand for `known`, in their order; `per_metre`: depth
// of the picture for a metre.
void mix_sources(const LayeredDepthImage& layers, const std::vector<KnownSample>& known,
                 double per_metre, std::vector<LayerSample>& out);

}  // namespace rilievo

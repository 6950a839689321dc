// What does the cache need to know of a layered impostor that is drawn one way or the other?
#pragma once

#include "rilievo/kind/drawable.h"
#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// The bound of its error, and the cost of drawing it, in triangles. Require the texels of its
// surfaces.
[[nodiscard]] ErrorModel layered_error_model(const LayeredImpostor& impostor,
                                             const LayeredOptions& options);
[[nodiscard]] CostTerms layered_cost_terms(const LayeredImpostor& impostor, LayeredMethod method);

}  // namespace rilievo

// How rough is what a layered picture shows, at least?
//
// A highlight lies elsewhere for each eye. No eye stands where the rays of a parallel picture meet:
// its layers are drawn for eyes up to 55 degrees aside, and a highlight as the picture's own
// direction sees it is wrong for nearly all of them. The mean over these eyes is a wide and faint
// highlight, about that of a rougher surface. (Means over directions themselves came out worse
// where normal maps or grazing reflections are: bench/results/seen.md.) A perspective picture has
// an eye, which sees it as it is. For sources that shade by the library's own model; ray tracers
// and programs shade as they do.
#pragma once

#include "rilievo/core/camera.h"

namespace rilievo {

// Smoother surfaces are shaded as if they were so rough. Of 0.5, 0.6, 0.8 and 1 the one whose
// frames are nearest to the true ones, of teapots (0.35 and 0.4) and of a helmet.
[[nodiscard]] inline float least_roughness(const Camera& camera) {
  constexpr float kOfParallel = 0.6f;
  return camera.projection == Projection::parallel ? kOfParallel : 0.0f;
}

}  // namespace rilievo
